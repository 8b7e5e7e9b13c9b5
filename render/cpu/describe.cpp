// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"

#include <fmt/format.h>

#include <set>

namespace nearfield::render {

std::string summary(const RenderReport& report, glm::ivec2 size_px) {
    return fmt::format(
        "{} x {} px; load {:.2f} s, build {:.2f} s, camera rays {:.2f} s, light sums {:.2f} s, "
        "visibility {:.2f} s; {:.3g} M camera rays, {:.3g} M shadow rays, {:.3g} G multiply-adds; "
        "sampling sigma mean {:.2g} %, worst {:.2g} %",
        size_px.x, size_px.y, report.load_s, report.build_s, report.camera_s, report.sums_s,
        report.visibility_s, 1e-6 * static_cast<double>(report.camera_rays),
        1e-6 * static_cast<double>(report.shadow_rays), 1e-9 * report.multiply_adds,
        100.0 * report.sigma_mean_rel, 100.0 * report.sigma_worst_rel);
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
                          {"seed", fmt::format("{}", options.seed)}};
    std::set<std::string> seen;
    for (const LuminaireInstance& luminaire : scene.luminaires)
        if (luminaire.on && luminaire.dim > 0.0 && seen.insert(luminaire.path).second)
            provenance.inputs.push_back(describe_input(luminaire.path));
    provenance.figures = {{"sampling_sigma_mean_rel", report.sigma_mean_rel},
                          {"sampling_sigma_worst_rel", report.sigma_worst_rel}};
    return provenance;
}

}  // namespace nearfield::render
