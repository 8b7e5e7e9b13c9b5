// SPDX-License-Identifier: Apache-2.0
#include "formats/report/gnuplot.h"
#include "formats/report/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::report {
namespace {

constexpr const char* kSvg =
    "set terminal svg size {},{} font 'sans,15' background '#ffffff' noenhanced\n";

std::string labels(const std::string& title, const std::string& x, const std::string& y) {
    return "set title " + quoted(title) + "\nset xlabel " + quoted(x) + "\nset ylabel " +
           quoted(y) + "\n";
}

std::optional<Image> svg_of(const std::string& script, const std::string& caption) {
    const std::optional<std::string> svg = run_gnuplot(script);
    return svg ? std::optional<Image>({"image/svg+xml", *svg, caption}) : std::nullopt;
}

struct Extent {
    glm::dvec3 low, high;

    glm::dvec3 size() const { return high - low; }
};

Extent extent_of(const Wireframe& wireframe) {
    constexpr double kFar = 1e300, kMargin = 0.02;
    glm::dvec3 low(kFar), high(-kFar);
    for (const Wireframe::Line& line : wireframe.lines)
        for (const glm::dvec3& point : line.points) {
            low = glm::min(low, point);
            high = glm::max(high, point);
        }
    const glm::dvec3 size = glm::max(high - low, glm::dvec3(1.0 / kFar));
    return {low - kMargin * size, high + kMargin * size};
}

// With equal scales gnuplot fits x and y into the picture; what is taller would be cut off.
double zoom_of(glm::dvec3 size) {
    constexpr double kFitting = 1.6;
    return std::min(1.0, kFitting * std::max(size.x, size.y) / glm::length(size));
}

// A step of 1, 2 or 5 times a power of ten, some six of which cover the longest axis.
double tics_of(glm::dvec3 size) {
    const double step = std::max({size.x, size.y, size.z}) / 6;
    const double decade = std::pow(10.0, std::floor(std::log10(step)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (step <= factor * decade)
            return factor * decade;
    return 10 * decade;
}

}  // namespace

std::optional<Image> draw(const VectorMap& map, const std::string& caption) {
    const glm::dvec2 low = map.flip_y ? glm::dvec2(map.lower.x, map.upper.y) : map.lower;
    const glm::dvec2 high = map.flip_y ? glm::dvec2(map.upper.x, map.lower.y) : map.upper;
    std::string script =
        fmt::format(fmt::runtime(kSvg), 900, 760) + labels(map.title, map.x_label, map.y_label);
    script += fmt::format(
        "set size ratio -1\nset grid\nset key outside top center horizontal\nset xrange "
        "[{:.8g}:{:.8g}]\nset yrange [{:.8g}:{:.8g}]\n",
        low.x, high.x, low.y, high.y);
    std::string command = "plot ";
    for (std::size_t k = 0; k < map.groups.size(); ++k) {
        const VectorMap::Vectors& group = map.groups[k];
        script += fmt::format("$group{} << EOD\n", k);
        for (std::size_t n = 0; n < group.at.size(); ++n) {
            const glm::dvec2 vector = map.enlargement * group.vector[n];
            script += fmt::format("{:.8g} {:.8g} {:.8g} {:.8g}\n", group.at[n].x, group.at[n].y,
                                  vector.x, vector.y);
        }
        script += "EOD\n";
        command += fmt::format("{}$group{} with vectors filled size screen 0.006,20 linecolor rgb ",
                               k == 0 ? "" : ", ", k) +
                   quoted(group.color) + " title " + quoted(group.name);
    }
    return svg_of(script + command + "\n", caption);
}

std::optional<Image> draw(const Wireframe& wireframe, const std::string& caption) {
    const Extent extent = extent_of(wireframe);
    std::string script = fmt::format(fmt::runtime(kSvg), 900, 700) +
                         labels(wireframe.title, wireframe.x_label, wireframe.y_label) +
                         "set zlabel " + quoted(wireframe.z_label) + " rotate\n";
    script += fmt::format(
        "set view {0:g},{1:g},{2:g}\nset xtics {3:g}\nset ytics {3:g}\nset ztics {3:g}\nset view "
        "equal xyz\nset xyplane relative 0.05\nset grid\nset key "
        "outside top center horizontal\n",
        wireframe.tilt_deg, wireframe.turn_deg, zoom_of(extent.size()), tics_of(extent.size()));
    for (int axis = 0; axis < 3; ++axis)
        script += fmt::format("set {}range [{:.8g}:{:.8g}]\n", "xyz"[axis], extent.low[axis],
                              extent.high[axis]);
    std::string command = "splot ";
    for (std::size_t k = 0; k < wireframe.lines.size(); ++k) {
        const Wireframe::Line& line = wireframe.lines[k];
        script += fmt::format("$line{} << EOD\n", k);
        for (const glm::dvec3& point : line.points)
            script += fmt::format("{:.8g} {:.8g} {:.8g}\n", point.x, point.y, point.z);
        script += "EOD\n";
        command += fmt::format("{}$line{} with lines linewidth 1.5 linecolor rgb ",
                               k == 0 ? "" : ", ", k) +
                   quoted(line.color) +
                   (line.name.empty() ? " notitle" : " title " + quoted(line.name));
    }
    return svg_of(script + command + "\n", caption);
}

}  // namespace nearfield::report
