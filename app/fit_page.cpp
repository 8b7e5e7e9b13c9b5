// SPDX-License-Identifier: Apache-2.0
#include "app/fit_page.h"

#include "app/calibration_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

using report::HeatMap;
using report::Section;

// A map over S.
HeatMap s_map(const Slab& slab,
              std::vector<double> values,
              const std::string& title,
              const std::string& label) {
    HeatMap map;
    map.title = title;
    map.x_label = "x on S, m";
    map.y_label = "y on S, m";
    map.value_label = label;
    map.lower = slab.s_min_m;
    map.upper = slab.s_max_m;
    map.size = slab.texels;
    map.values = std::move(values);
    for (const double value : map.values)
        if (std::isfinite(value))
            map.high = std::max(map.high, value);
    const glm::dvec2 size_m = slab.s_max_m - slab.s_min_m;
    constexpr int kWidth_px = 800;
    map.picture_px = {
        kWidth_px,
        std::clamp(static_cast<int>(kWidth_px * 0.68 * size_m.y / size_m.x) + 110, 260, 900)};
    return map;
}

HeatMap view_map(const LensView& view) {
    HeatMap map;
    map.lower = view.lower_m;
    map.upper = view.upper_m;
    map.size = view.size_px;
    map.values = view.cd_per_m2;
    map.title = fmt::format("From ({:+.1f}, {:+.1f}) degrees", 57.29578 * std::atan(view.tangent.x),
                            57.29578 * std::atan(view.tangent.y));
    map.x_label = "x on U, m (drawn as seen from before the lamp)";
    map.y_label = "y on U, m";
    map.value_label = "cd/m^2";
    map.palette = report::Palette::Gray;
    map.flip_x = true;
    map.high = std::max(1e-12, *std::max_element(map.values.begin(), map.values.end()));
    map.picture_px = {620, 480};
    return map;
}

Section lamp_section(const FitLight& light) {
    Section section{"The lamp", {}, {}, {}, {}};
    for (const LensView& view : light.views)
        add_drawing(section, draw(view_map(view), "The lens by its measured light."));
    section.columns = 2;
    return section;
}

// Sigma over light, where a thousandth of the brightest falls; else none.
std::vector<double> relative_sigma(const FitLight& light) {
    const double least_lx = 1e-3 * *std::max_element(light.on_s_lx.begin(), light.on_s_lx.end());
    std::vector<double> relative(light.on_s_lx.size());
    for (std::size_t t = 0; t < relative.size(); ++t)
        relative[t] = light.on_s_lx[t] > least_lx ? light.on_s_sigma_lx[t] / light.on_s_lx[t] : NAN;
    return relative;
}

Section light_section(const Slab& slab, const FitLight& light) {
    Section section{"Light on S, and how well it is known", {}, {}, {}, {}};
    HeatMap map = s_map(slab, light.on_s_lx, "Illuminance of S without filter", "lx");
    map.low = 1e-3 * map.high;
    map.log_scale = true;
    add_drawing(section, draw(map, "The sum over all images."));
    std::vector<double> percent = relative_sigma(light);
    for (double& value : percent)
        value *= 100;
    add_drawing(section, draw(s_map(slab, std::move(percent), "Its sigma from noise", "%"),
                              "Independent errors of the coefficients; what is common to all is in "
                              "the scale. Blank: darker than a thousandth of the brightest."));
    return section;
}

double median_of(std::vector<double> values) {
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty())
        return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

report::Plot shares_plot(const fit::PositionShares& shares) {
    report::Plot plot{"Positions, asked of those that were held out",
                      "share of the positions in the fit",
                      "chi-square by held-out measurement",
                      {}};
    plot.curves = {{"held out", shares.share, shares.chi_square, report::Marks::Dots}};
    plot.log_y = true;
    return plot;
}

Section more_section(const fit::CaptureFit& fit, const FitLight& light) {
    Section section{"What more of it would buy", {}, {}, {}, {}};
    const double noise_rel = median_of(relative_sigma(light));
    report::Table table{"", {"more", "costs", "buys"}, {}};
    table.rows.push_back(
        {"four times the exposures",
         fmt::format("at most {:.0f} instead of {:.0f} minutes of capture", 4 * fit.capture_s / 60,
                     fit.capture_s / 60),
         fmt::format(
             "half the noise: {:.2g} % instead of {:.2g} % of a texel's light, in the median",
             50 * noise_rel, 100 * noise_rel)});
    const std::vector<double>& chi_square = fit.shares.chi_square;
    if (chi_square.size() > 1)
        table.rows.push_back(
            {"positions", fmt::format("{:.1f} s each", fit.capture_s / std::max(1, fit.positions)),
             fmt::format(
                 "{:.0f} % of the positions foretell the others with {:.2g} times the error "
                 "that {:.0f} % of them make: as much again is to be had only while this "
                 "falls",
                 100 * fit.shares.share.back(), std::sqrt(chi_square.back() / chi_square.front()),
                 100 * fit.shares.share.front())});
    table.rows.push_back(
        {"a better rig, a finer basis", "",
         fmt::format("less of the {:.2g} % that rig and basis get wrong of a "
                     "texel's brightest position, as positions foretell each other",
                     100 * fit.model_error_rel)});
    section.tables = {std::move(table)};
    if (chi_square.size() > 1)
        add_drawing(section, draw(shares_plot(fit.shares),
                                  "Smoothness and error of rig and basis as chosen with all."));
    return section;
}

Section residual_section(const fit::CaptureFit& fit) {
    const Slab& slab = fit.lightfield.slabs.front();
    Section section{"Residuals", {}, {}, {}, {}};
    section.paragraphs.push_back(
        fmt::format("Chi-square by degree of freedom {:.2f}: 1 where noise explains what is left; "
                    "exposures against "
                    "each other {:.2f}. The conditions of the optimum hold to {:.1e}; {} of {} "
                    "texels and channels "
                    "did not reach 1e-6, {} are not seen.",
                    fit.report.reduced_chi_square(), fit.exposure_chi_square, fit.report.kkt_worst,
                    fit.report.unconverged_count, fit.report.texel_count, fit.report.unseen_count));
    HeatMap map = s_map(slab, {fit.chi_square.begin(), fit.chi_square.end()},
                        "Chi-square by degree of freedom, first channel", "");
    map.low = 0.1;
    map.log_scale = true;
    map.high = std::max(10.0, std::min(map.high, 1e4));
    add_drawing(section, draw(map,
                              "Structure in it is light that the basis cannot have, or a position "
                              "that is not where it was said to be."));
    if (!fit.smoothness.lambda.empty()) {
        report::Plot plot{"Smoothness, asked of positions that were held out",
                          "lambda",
                          "chi-square by held-out measurement",
                          {}};
        report::Curve curve{"held out", {}, {}, report::Marks::Dots};
        for (std::size_t k = 0; k < fit.smoothness.lambda.size(); ++k) {
            curve.x.push_back(fit.smoothness.lambda[k]);
            curve.y.push_back(fit.smoothness.chi_square[k]);
        }
        plot.curves = {std::move(curve)};
        plot.log_x = plot.log_y = true;
        add_drawing(section,
                    draw(plot, fmt::format("The least is taken: lambda {:g}.", fit.lambda)));
    }
    return section;
}

Section facts_section(const fit::CaptureFit& fit, const FitLight& light) {
    const Slab& slab = fit.lightfield.slabs.front();
    report::Table table{"", {"what", "value"}, {}};
    const auto row = [&table](const std::string& what, const std::string& value) {
        table.rows.push_back({what, value});
    };
    row("flux", fmt::format("{:.5g} lm +- {:.2g} ({}) +- {:.2g} % (scale)", light.flux_lm,
                            light.flux_sigma_lm, fit.replicates > 0 ? "noise and rig" : "noise",
                            100 * fit.lightfield.scale_sigma_rel));
    row("images", fmt::format("{} x {} of {} x {} texels, {}", slab.grid.x, slab.grid.y,
                              slab.texels.x, slab.texels.y, slab.profile.name));
    row("resolution on S", fmt::format("{:.2f} mm (a texel is {:.2f} cells of the sensor)",
                                       1e3 * fit.resolution_m, fit.texel_cells_least));
    row("blur of directions",
        fmt::format("{:.2f} degrees: a basis function's pitch over the planes' distance",
                    57.29578 * slab.pitch_m.x / slab.delta_m));
    row("error of rig and basis, in every weight",
        fmt::format("{:.2g} % of a texel's brightest position", 100 * fit.model_error_rel));
    row("positions", fmt::format("{}, {} missing", fit.positions, fit.missing_positions));
    row("saturated in all exposures", fmt::format("{:.3g} % of pixels", 100 * fit.saturated_share));
    row("light beside the extent", fmt::format("{:.2g} %", 100 * fit.outside_share));
    if (fit.beside_filter.empty())
        row("light beside the filter", "not measured, not taken off");
    for (const fit::BesideFilter& channel : fit.beside_filter)
        row("light beside the filter, taken off (as through a filter of peak 1)",
            fmt::format("{:.3g} +- {:.1g} lx; chi-square of its picture {:.2f}", channel.mean_lx,
                        channel.sigma_lx, channel.chi_square));
    row("the lamp's drift, taken off", fmt::format("up to {:.2g} %", 100 * fit.drift_rel));
    row("time", fmt::format("merge {:.1f} s, smoothness {:.1f} s, solve {:.1f} s", fit.merge_s,
                            fit.smoothness_s, fit.solve_s));
    return {"In short", {}, {}, {std::move(table)}, {}};
}

}  // namespace

report::Page fit_page(const fit::CaptureFit& fit,
                      const FitLight& light,
                      const std::string& command) {
    report::Page page{"Fit", "A lamp's light field from measured frames.", {}};
    page.sections = {facts_section(fit, light),
                     lamp_section(light),
                     light_section(fit.lightfield.slabs.front(), light),
                     residual_section(fit),
                     more_section(fit, light),
                     {"How it was made", {}, {}, {}, command}};
    return page;
}

}  // namespace nearfield::app
