// SPDX-License-Identifier: Apache-2.0
#include "app/bench/page_plots.h"

#include "app/bench/summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nearfield::bench {
namespace {

// Okabe and Ito's colors, which color-blind readers can tell apart; a sampler's is the same in all
// plots.
std::string color_of(const std::string& sampler) {
    constexpr std::array<std::pair<const char*, const char*>, 6> kColors = {{
        {"sum", "#000000"},
        {"uniform", "#999999"},
        {"precomputed", "#cc79a7"},
        {"pdis", "#d55e00"},
        {"systematic", "#0072b2"},
        {"cells", "#009e73"},
    }};
    for (const auto& [name, color] : kColors)
        if (sampler == name)
            return color;
    return "";
}

report::Curve curve_of(const std::vector<const Result*>& results,
                       const std::string& name,
                       const std::string& color) {
    report::Curve curve;
    curve.name = name;
    curve.marks = report::Marks::Dots;
    curve.color = color;
    for (const Result* result : results) {
        curve.x.push_back(result->time_us);
        curve.y.push_back(result->error.rms);
        curve.y_low.push_back(result->rms_low);
        curve.y_high.push_back(result->rms_high);
    }
    return curve;
}

report::Plot log_plot(const std::string& title,
                      const std::string& x_label,
                      const std::string& y_label) {
    report::Plot plot;
    plot.title = title;
    plot.x_label = x_label;
    plot.y_label = y_label;
    plot.log_x = plot.log_y = true;
    return plot;
}

constexpr const char* kTimeLabel = "wall time a point, us";
constexpr const char* kErrorLabel = "relative RMS error (1 = 100 %)";

report::HeatMap wall_map(const WallPictures& wall) {
    report::HeatMap map;
    map.x_label = "x, m";
    map.y_label = "y, m";
    map.lower = wall.wall.lower_m;
    map.upper = wall.wall.upper_m;
    map.size = wall.wall.size;
    map.flip_x = true;  // as seen from the lamp
    map.picture_px = {560, std::clamp(180 + 400 * wall.wall.size.y / wall.wall.size.x, 240, 560)};
    return map;
}

}  // namespace

report::Plot error_against_time(const Findings& findings) {
    report::Plot plot = log_plot("Error against time", kTimeLabel, kErrorLabel);
    for (const std::string& curve : curves_of(findings, "samplers"))
        plot.curves.push_back(
            curve_of(results_of(findings, "samplers", curve), curve, color_of(curve)));
    report::Curve front;
    front.name = "none better";
    front.marks = report::Marks::Circles;
    front.color = "#000000";
    const std::vector<const Result*> all = results_of(findings, "samplers");
    const std::vector<bool> is_on_front = on_front(findings);
    for (std::size_t k = 0; k < all.size(); ++k)
        if (is_on_front[k]) {
            front.x.push_back(all[k]->time_us);
            front.y.push_back(all[k]->error.rms);
        }
    plot.curves.push_back(std::move(front));
    return plot;
}

report::Plot error_against_k(const Findings& findings) {
    report::Plot plot =
        log_plot("Error against the number of samples", "samples a point, K", kErrorLabel);
    for (const std::string& name : curves_of(findings, "samplers")) {
        if (name == "sum")
            continue;
        const std::vector<const Result*> results = results_of(findings, "samplers", name);
        report::Curve curve = curve_of(results, name, color_of(name));
        for (std::size_t k = 0; k < results.size(); ++k)
            curve.x[k] = results[k]->of.method.size();
        plot.curves.push_back(std::move(curve));
    }
    return plot;
}

report::Plot time_against_k(const Findings& findings) {
    report::Plot plot =
        log_plot("Time against the number of samples", "samples a point, K", kTimeLabel);
    double least_k = std::numeric_limits<double>::infinity(), most_k = 0.0;
    for (const std::string& name : curves_of(findings, "samplers")) {
        if (name == "sum")
            continue;
        report::Curve curve;
        curve.name = name;
        curve.marks = report::Marks::Dots;
        curve.color = color_of(name);
        for (const Result* result : results_of(findings, "samplers", name)) {
            curve.x.push_back(result->of.method.size());
            curve.y.push_back(result->time_us);
            least_k = std::min(least_k, curve.x.back());
            most_k = std::max(most_k, curve.x.back());
        }
        plot.curves.push_back(std::move(curve));
    }
    const std::vector<const Result*> sum = results_of(findings, "samplers", "sum");
    if (!sum.empty() && most_k > 0.0)
        plot.curves.push_back({"exact sum, no samples",
                               {least_k, most_k},
                               {sum.back()->time_us, sum.back()->time_us},
                               report::Marks::None,
                               {},
                               {},
                               color_of("sum")});
    return plot;
}

report::Plot knob_plot(const Findings& findings, const std::string& sweep) {
    report::Plot plot = log_plot("Error against time", kTimeLabel, kErrorLabel);
    for (const std::string& curve : curves_of(findings, sweep))
        plot.curves.push_back(curve_of(results_of(findings, sweep, curve), curve, color_of(curve)));
    return plot;
}

report::HeatMap light_map(const WallPictures& wall, const WallPicture& picture) {
    report::HeatMap map = wall_map(wall);
    map.title = picture.sampler;
    map.value_label = "illuminance";
    map.palette = report::Palette::Gray;
    map.values.assign(picture.y.begin(), picture.y.end());
    map.high = *std::max_element(wall.truth_y.begin(), wall.truth_y.end());
    return map;
}

report::HeatMap error_map(const WallPictures& wall, const WallPicture& picture) {
    report::HeatMap map = wall_map(wall);
    map.title = picture.sampler + ", error";
    map.value_label = "relative error";
    map.log_scale = true;
    map.low = 1e-3;
    map.high = 1.0;
    const float least = 1e-3F * *std::max_element(wall.truth_y.begin(), wall.truth_y.end());
    for (std::size_t k = 0; k < picture.y.size(); ++k)
        map.values.push_back(wall.truth_y[k] > least
                                 ? std::abs(picture.y[k] / wall.truth_y[k] - 1.0F)
                                 : std::numeric_limits<float>::quiet_NaN());
    return map;
}

}  // namespace nearfield::bench
