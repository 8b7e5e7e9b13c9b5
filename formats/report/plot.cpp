// SPDX-License-Identifier: Apache-2.0
#include "formats/report/plot.h"

#include "formats/report/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::report {
namespace {

bool is_shown(double value, bool log_scale) {
    return std::isfinite(value) && (!log_scale || value > 0.0);
}

// A curve's points as a block of lines "x y low high"; a blank line interrupts its line.
std::string data_block(const Plot& plot, std::size_t k) {
    const Curve& curve = plot.curves[k];
    std::string block = fmt::format("$curve{} << EOD\n", k);
    for (std::size_t at = 0; at < curve.x.size(); ++at) {
        const double x = curve.x[at], y = curve.y[at];
        if (!is_shown(x, plot.log_x) || !is_shown(y, plot.log_y)) {
            block += "\n";
            continue;
        }
        const double low = curve.y_low.empty() ? y : curve.y_low[at];
        const double high = curve.y_high.empty() ? y : curve.y_high[at];
        // A bar that reaches below a logarithmic axis ends a decade under its point.
        block += fmt::format("{:.8g} {:.8g} {:.8g} {:.8g}\n", x, y,
                             is_shown(low, plot.log_y) ? low : 0.1 * y, high);
    }
    return block + "EOD\n";
}

// How gnuplot is to draw curve k: one or two elements of its plot command, bars below the points.
std::string plot_elements(const Curve& curve, std::size_t k) {
    const std::string color = curve.color.empty() ? fmt::format("linetype {}", k + 1)
                                                  : "linecolor rgb " + quoted(curve.color);
    const std::string data = fmt::format("$curve{} using 1:2", k);
    const std::string title = " " + color + " title " + quoted(curve.name);
    switch (curve.marks) {
        case Marks::None:
            return data + " with lines linewidth 1.5" + title;
        case Marks::Circles:
            return data + " with points pointtype 6 pointsize 1.4 linewidth 1.5" + title;
        case Marks::Dots:
            break;
    }
    const std::string bars =
        curve.y_low.empty()
            ? std::string()
            : fmt::format("$curve{} using 1:3:(0):($4-$3) with vectors nohead linewidth 3 ", k) +
                  color + " notitle, ";
    return bars + data + " with linespoints linewidth 1.5 pointtype 7 pointsize 0.5" + title;
}

}  // namespace

std::optional<Image> draw(const Plot& plot, const std::string& caption) {
    std::string script =
        "set terminal svg size 900,480 font 'sans,15' background '#ffffff' noenhanced\n"
        "set grid\nset key outside top center horizontal\n";
    script += "set title " + quoted(plot.title) + "\nset xlabel " + quoted(plot.x_label) +
              "\nset ylabel " + quoted(plot.y_label) + "\n";
    script += plot.log_y ? "set logscale y\nset format y '%g'\n" : "";
    script += plot.log_x ? "set logscale x\nset format x '%g'\n" : "";
    std::string command = "plot ";
    for (std::size_t k = 0; k < plot.curves.size(); ++k) {
        script += data_block(plot, k);
        command += (k == 0 ? "" : ", ") + plot_elements(plot.curves[k], k);
    }
    const std::optional<std::string> svg = run_gnuplot(script + command + "\n");
    return svg ? std::optional<Image>({"image/svg+xml", *svg, caption}) : std::nullopt;
}

std::optional<Image> draw(const HeatMap& map, const std::string& caption) {
    std::string script = fmt::format("set terminal pngcairo size {},{} noenhanced\n",
                                     map.picture_px.x, map.picture_px.y);
    script += map.palette == Palette::Gray
                  ? "set palette functions gray**0.45, gray**0.45, gray**0.45\n"
                  : "set palette defined (0 '#000020', 1 '#1040a0', 2 '#00a0a0', 3 '#20c020', 4 "
                    "'#f0e020', 5 '#ff7000', 6 '#ffffff')\n";
    script += "set title " + quoted(map.title) + "\nset xlabel " + quoted(map.x_label) +
              "\nset ylabel " + quoted(map.y_label) + "\nset cblabel " + quoted(map.value_label) +
              "\nset rmargin at screen 0.8\n";
    script += map.log_scale ? "set logscale cb\nset format cb '%g'\n" : "";
    script += fmt::format("set cbrange [{:.8g}:{:.8g}]\n", map.low, map.high);
    script += map.flip_x ? fmt::format("set xrange [{:.8g}:{:.8g}]\n", map.upper.x, map.lower.x)
                         : fmt::format("set xrange [{:.8g}:{:.8g}]\n", map.lower.x, map.upper.x);
    const auto [bottom, top] =
        map.flip_y ? std::pair(map.upper.y, map.lower.y) : std::pair(map.lower.y, map.upper.y);
    script += fmt::format("set yrange [{:.8g}:{:.8g}]\nunset key\n$map << EOD\n", bottom, top);
    const glm::dvec2 step = (map.upper - map.lower) / glm::dvec2(map.size);
    for (int row = 0; row < map.size.y; ++row) {
        for (int column = 0; column < map.size.x; ++column) {
            const glm::dvec2 at = map.lower + (glm::dvec2(column, row) + 0.5) * step;
            const double value =
                map.values[static_cast<std::size_t>(row) * static_cast<std::size_t>(map.size.x) +
                           static_cast<std::size_t>(column)];
            script += std::isnan(value) ? fmt::format("{:.8g} {:.8g} NaN\n", at.x, at.y)
                                        : fmt::format("{:.8g} {:.8g} {:.8g}\n", at.x, at.y,
                                                      std::max(value, map.low));
        }
    }
    const std::optional<std::string> png =
        run_gnuplot(script + "EOD\nplot $map using 1:2:3 with image\n");
    return png ? std::optional<Image>({"image/png", *png, caption}) : std::nullopt;
}

}  // namespace nearfield::report
