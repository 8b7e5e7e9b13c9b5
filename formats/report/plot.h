// SPDX-License-Identifier: Apache-2.0
/// Plots drawn by gnuplot, which is looked for when a plot is asked for.
#pragma once

#include "formats/report/page.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield::report {

enum class Marks {
    None,     // a line alone
    Dots,     // a line and its points
    Circles,  // large open circles, no line: what stands out among other curves' points
};

struct Curve {
    std::string name;
    std::vector<double> x, y;  // of equal length; points that are not finite are left out
    Marks marks = Marks::None;
    std::vector<double> y_low = {}, y_high = {};  // ends of error bars, [point]; empty: none
    std::string color = {};                       // "#rrggbb"; empty: the next of gnuplot's
};

struct Plot {
    std::string title, x_label, y_label;  // labels with unit
    std::vector<Curve> curves;
    bool log_y = false;  // values <= 0 are left out
    bool log_x = false;  // the same along x
};

enum class Palette {
    FalseColor,  // black, blue, green, yellow, white
    Gray,        // as a display shows it: half the value is three quarters of the brightness
};

/// A map of values in false color with a scale beside it.
struct HeatMap {
    std::string title, x_label, y_label, value_label;
    glm::dvec2 lower{0.0}, upper{0.0};  // of the map's rectangle, in the axes' units
    glm::ivec2 size{0};
    std::vector<double> values;  // [row from the bottom][column]; NaN is left blank
    double low = 0, high = 0;    // range of the scale
    bool log_scale = false;      // values below `low` are drawn as `low`
    bool flip_x = false;         // x rises to the left
    bool flip_y = false;         // y rises downwards, as in pictures
    Palette palette = Palette::FalseColor;
    glm::ivec2 picture_px{1000, 480};
};

/// Small vectors at places of a picture or plane, drawn enlarged.
struct VectorMap {
    std::string title, x_label, y_label;
    glm::dvec2 lower{0.0}, upper{0.0};  // of the drawing, in the axes' units
    bool flip_y = false;                // y rises downwards, as in pictures
    double enlargement = 1.0;
    struct Vectors {
        std::string name, color;  // "#rrggbb"
        std::vector<glm::dvec2> at, vector;
    };
    std::vector<Vectors> groups;
};

/// Lines in space, seen from a corner, all axes to the same scale.
struct Wireframe {
    std::string title, x_label, y_label, z_label;
    double turn_deg = 30, tilt_deg = 60;  // gnuplot's view: tilt from above, then turn
    struct Line {
        std::string name;  // in the legend; empty: not there
        std::string color;
        std::vector<glm::dvec3> points;
    };
    std::vector<Line> lines;
};

/// Nothing where gnuplot is not installed or fails; the caller says so on its page.
std::optional<Image> draw(const Plot& plot, const std::string& caption);
std::optional<Image> draw(const HeatMap& map, const std::string& caption);
std::optional<Image> draw(const VectorMap& map, const std::string& caption);
std::optional<Image> draw(const Wireframe& wireframe, const std::string& caption);

}  // namespace nearfield::report
