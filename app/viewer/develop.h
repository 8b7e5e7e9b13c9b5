// SPDX-License-Identifier: Apache-2.0
/// From mixed light to the pixels of a window.
#pragma once

#include "app/viewer/light.h"
#include "render/display.h"

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::viewer {

enum class Shown {
    Picture,  // tone-mapped radiance
    Lux,      // irradiance in false colors
    Error,    // estimated relative error in false colors
};

struct Look {
    Shown shown = Shown::Picture;
    render::DisplayOptions display;
    double least_lux = 0.1, most_lux = 1000;  // ends of the scale, which is logarithmic
    bool has_isolux = false;
    std::array<double, 8> isolux = {0.5, 1, 3, 10, 30, 100, 300, 1000};  // lines

    bool operator==(const Look&) const;
};

/// The scale's color at 0 ... 1: dark blue, blue, cyan, green, yellow, red, white; 8-bit sRGB.
glm::u8vec3 scale_color(double position);
/// Where a value lies on the scale between two ends, 0 ... 1, logarithmic.
double scale_position(double value, double least, double most);

struct Developed {
    glm::ivec2 size_px{0};
    std::vector<unsigned char> rgba;  // [row from the top][column]
    double exposure_ev = 0;           // as used
};

/// Tone mapping is render::display's, bit by bit.
Developed develop(const Frame& frame, const Mixed& mixed, const Look& look);

/// Left of `split` of the width (0 ... 1) one picture, right of it the other, on whose pixels both
/// are; a line between.
Developed beside(const Developed& left, const Developed& right, double split);

/// Lab difference and error map of two mixed views of one size: as render's comparison.
struct Difference {
    double lab = 0, rms_rel = 0, p95_rel = 0;
    Developed map;  // |a/b - 1| in false colors, 0.1 % ... 100 %
};
Difference difference_of(const Mixed& a, const Mixed& b);

}  // namespace nearfield::viewer
