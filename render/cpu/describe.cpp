// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace nearfield::render {

std::string summary(const RenderReport& report, glm::ivec2 size_px) {
    return fmt::format(
        "{} x {} px; load {:.2f} s, build {:.2f} s, camera rays {:.2f} s, light sums {:.2f} s, "
        "visibility {:.2f} s; {:.3g} M camera rays, {:.3g} M shadow rays, {:.3g} G multiply-adds; "
        "{}{}",
        size_px.x, size_px.y, report.load_s, report.build_s, report.camera_s, report.sums_s,
        report.visibility_s, 1e-6 * static_cast<double>(report.camera_rays),
        1e-6 * static_cast<double>(report.shadow_rays), 1e-9 * report.multiply_adds,
        summary(report.sampling),
        report.has_sigma_measured ? "; with the layer sigma_measured" : "");
}

std::string summary(const Noise& noise) {
    return fmt::format(
        "sampling sigma {:.2g} % mean, {:.2g} % or less on 95 % of the lit pixels, above 10 % on "
        "{:.2g} % of them",
        100.0 * noise.mean_rel, 100.0 * noise.p95_rel, 100.0 * noise.share_above_10_percent);
}

Noise summarize_noise(const Layer& radiance, const Layer& sigma) {
    constexpr float kFloor = 1e-3F;  // of the largest, as for relative RMS
    const auto luminance = [&](std::size_t i) {
        return shared::luminance709(
            {radiance.values[3 * i], radiance.values[3 * i + 1], radiance.values[3 * i + 2]});
    };
    float brightest = 0.0F;
    for (std::size_t i = 0; i < sigma.values.size(); ++i)
        brightest = std::max(brightest, luminance(i));
    std::vector<double> lit;
    for (std::size_t i = 0; i < sigma.values.size(); ++i)
        if (luminance(i) > kFloor * brightest)
            lit.push_back(static_cast<double>(sigma.values[i] / luminance(i)));
    Noise noise;
    if (lit.empty())
        return noise;
    const auto count = static_cast<double>(lit.size());
    for (const double relative : lit) {
        noise.mean_rel += relative / count;
        noise.share_above_10_percent += relative > 0.1 ? 1.0 / count : 0.0;
    }
    const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.95 * count)) - 1;
    std::nth_element(lit.begin(), lit.begin() + rank, lit.end());
    noise.p95_rel = lit[static_cast<std::size_t>(rank)];
    return noise;
}

Provenance describe(const Scene& scene, const RenderOptions& options, const RenderReport& report) {
    Provenance provenance;
    provenance.program = program_version();
    provenance.command = "render";
    provenance.options = {{"width", fmt::format("{}", options.size_px.x)},
                          {"height", fmt::format("{}", options.size_px.y)},
                          {"camera", options.camera},
                          {"samples-per-pixel", fmt::format("{}", options.samples_per_pixel)},
                          {"visibility-samples", fmt::format("{}", options.visibility_samples)},
                          {"seed", fmt::format("{}", options.seed)},
                          {"sigma-measured", options.sigma_measured ? "true" : "false"}};
    std::set<std::string> seen;
    for (const LuminaireInstance& luminaire : scene.luminaires)
        if (luminaire.on && luminaire.dim > 0.0 && seen.insert(luminaire.path).second)
            provenance.inputs.push_back(describe_input(luminaire.path));
    provenance.figures = {
        {"sampling_sigma_mean_rel", report.sampling.mean_rel},
        {"sampling_sigma_p95_rel", report.sampling.p95_rel},
        {"sampling_sigma_share_above_10_percent", report.sampling.share_above_10_percent}};
    return provenance;
}

}  // namespace nearfield::render
