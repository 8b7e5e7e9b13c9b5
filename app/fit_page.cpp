// SPDX-License-Identifier: Apache-2.0
#include "app/fit_page.h"

#include "app/calibration_page.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"

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

// Luminance weights of a slab's channels.
std::vector<double> channel_weights(const Slab& slab) {
    if (slab.channels == 1)
        return {1.0};
    return {kLuminanceRgb.begin(), kLuminanceRgb.end()};
}

// Illuminance of S, the sum over images, and its sigma, [j][i].
struct OnS {
    std::vector<double> lx, sigma_lx;
};

OnS illuminance_on_s(const Slab& slab) {
    OnS on_s{std::vector<double>(slab.texel_count()), std::vector<double>(slab.texel_count())};
    const std::vector<double> weights = channel_weights(slab);
    for (int m = 0; m < slab.image_count(); ++m)
        for (std::size_t t = 0; t < slab.texel_count(); ++t) {
            double sigma = 0;
            for (int c = 0; c < slab.channels; ++c) {
                const std::size_t at = slab.image_offset(c, m) + t;
                const double weight = weights[static_cast<std::size_t>(c)];
                on_s.lx[t] += weight * double(slab.coeffs[at]);
                if (!slab.sigma.empty() && std::isfinite(slab.sigma[at]))
                    sigma += weight * double(slab.sigma[at]);
            }
            on_s.sigma_lx[t] += sigma * sigma;
        }
    // A basis function's integral over U turns coefficients into lux.
    const double integral = model::integral(slab.profile);
    const double area_m2 = integral * integral * slab.pitch_m.x * slab.pitch_m.y;
    for (std::size_t t = 0; t < slab.texel_count(); ++t) {
        on_s.lx[t] *= area_m2;
        on_s.sigma_lx[t] = area_m2 * std::sqrt(on_s.sigma_lx[t]);
    }
    return on_s;
}

// The lens as it is seen from a direction, cd/m^2.
HeatMap seen_from(const Slab& slab, glm::dvec2 tangent) {
    constexpr int kColumns = 96;
    const glm::dvec2 half_m = 0.5 * (glm::dvec2(slab.grid) + 1.0) * slab.pitch_m;
    HeatMap map;
    map.lower = slab.u_center_m - half_m;
    map.upper = slab.u_center_m + half_m;
    map.size = {kColumns, static_cast<int>(kColumns * half_m.y / half_m.x)};
    map.title = fmt::format("From ({:+.1f}, {:+.1f}) degrees", 57.29578 * std::atan(tangent.x),
                            57.29578 * std::atan(tangent.y));
    map.x_label = "x on U, m (drawn as seen from before the lamp)";
    map.y_label = "y on U, m";
    map.value_label = "cd/m^2";
    map.palette = report::Palette::Gray;
    map.flip_x = true;
    const glm::dvec2 step_m = (map.upper - map.lower) / glm::dvec2(map.size);
    for (int row = 0; row < map.size.y; ++row)
        for (int column = 0; column < map.size.x; ++column) {
            const glm::dvec2 u_m = map.lower + (glm::dvec2(column, row) + 0.5) * step_m;
            const double value =
                model::luminance(model::radiance(slab, u_m, u_m + slab.delta_m * tangent));
            map.values.push_back(value);
            map.high = std::max(map.high, value);
        }
    map.high = std::max(map.high, 1e-12);
    map.picture_px = {620, 480};
    return map;
}

Section lamp_section(const Slab& slab, const OnS& on_s) {
    Section section{"The lamp", {}, {}, {}, {}};
    const auto brightest = std::max_element(on_s.lx.begin(), on_s.lx.end()) - on_s.lx.begin();
    const auto column = static_cast<int>(brightest) % slab.texels.x;
    const auto row = static_cast<int>(brightest) / slab.texels.x;
    const glm::dvec2 hot_m = slab.s_min_m + (glm::dvec2(column, row) + 0.5) * slab.texel_m();
    const glm::dvec2 hot = (hot_m - slab.u_center_m) / slab.delta_m;
    const double spread = 0.35 * (slab.s_max_m.x - slab.s_min_m.x) / slab.delta_m;
    for (const glm::dvec2 offset : {glm::dvec2(0.0), glm::dvec2(-spread, 0.0),
                                    glm::dvec2(spread, 0.0), glm::dvec2(0.0, -0.4 * spread)})
        add_drawing(section,
                    draw(seen_from(slab, hot + offset), "The lens by its measured light."));
    section.columns = 2;
    return section;
}

Section light_section(const Slab& slab, const OnS& on_s) {
    Section section{"Light on S, and how well it is known", {}, {}, {}, {}};
    HeatMap light = s_map(slab, on_s.lx, "Illuminance of S without filter", "lx");
    light.low = 1e-3 * light.high;
    light.log_scale = true;
    add_drawing(section, draw(light, "The sum over all images."));
    std::vector<double> relative(on_s.lx.size());
    for (std::size_t t = 0; t < relative.size(); ++t)
        relative[t] = on_s.lx[t] > light.low ? 100 * on_s.sigma_lx[t] / on_s.lx[t] : NAN;
    add_drawing(section, draw(s_map(slab, std::move(relative), "Its sigma from noise", "%"),
                              "Independent errors of the coefficients; what is common to all is in "
                              "the scale. Blank: darker than a thousandth of the brightest."));
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

Section facts_section(const fit::CaptureFit& fit) {
    const Slab& slab = fit.lightfield.slabs.front();
    report::Table table{"", {"what", "value"}, {}};
    const auto row = [&table](const std::string& what, const std::string& value) {
        table.rows.push_back({what, value});
    };
    row("flux",
        fmt::format("{:.5g} lm +- {:.2g} (noise) +- {:.2g} % (scale)",
                    model::luminance(model::flux(fit.lightfield)),
                    model::flux_sigma_y(fit.lightfield), 100 * fit.lightfield.scale_sigma_rel));
    row("images", fmt::format("{} x {} of {} x {} texels, {}", slab.grid.x, slab.grid.y,
                              slab.texels.x, slab.texels.y, slab.profile.name));
    row("resolution on S", fmt::format("{:.2f} mm (a texel is {:.2f} cells of the sensor)",
                                       1e3 * fit.resolution_m, fit.texel_cells_least));
    row("blur of directions",
        fmt::format("{:.2f} degrees: a basis function's pitch over the planes' distance",
                    57.29578 * slab.pitch_m.x / slab.delta_m));
    row("error of rig and basis, in every sigma",
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

report::Page fit_page(const fit::CaptureFit& fit, const std::string& command) {
    const Slab& slab = fit.lightfield.slabs.front();
    const OnS on_s = illuminance_on_s(slab);
    report::Page page{"Fit", "A lamp's light field from measured frames.", {}};
    page.sections = {facts_section(fit),
                     lamp_section(slab, on_s),
                     light_section(slab, on_s),
                     residual_section(fit),
                     {"How it was made", {}, {}, {}, command}};
    return page;
}

}  // namespace nearfield::app
