// SPDX-License-Identifier: Apache-2.0
#include "sample_data/simulate.h"

#include "formats/files/points.h"
#include "sample_data/reference_lamp.h"

#include <fmt/format.h>

namespace nearfield::sample_data {
namespace {

constexpr glm::ivec2 kWallPoints{41, 31};

Provenance provenance_of(const SimulateOptions& options) {
    const auto size = [](glm::ivec2 value) { return fmt::format("{}x{}", value.x, value.y); };
    Provenance provenance;
    provenance.program = program_version();
    provenance.command = "simulate";
    provenance.options = {
        {"lamp", "headlight"},
        {"delta-m", fmt::format("{}", options.delta_m)},
        {"grid", size(options.grid)},
        {"texels", size(options.texels)},
        {"basis", options.basis},
        {"weighting", options.weighting == Weighting::Irradiance ? "irradiance" : "radiance"},
        {"channels", fmt::format("{}", options.channels)},
        {"seed", fmt::format("{}", options.seed)},
        {"refine", fmt::format("{}", options.refine)}};
    return provenance;
}

}  // namespace

SimulatedHeadlight simulate_headlight(const SimulateOptions& options,
                                      const std::function<void(double fraction)>& progress) {
    SimulatedHeadlight result;
    result.headlight = make_headlight(options.seed);
    const Slab planes = headlight_planes(options.delta_m, options.grid, options.texels,
                                         options.basis, options.weighting, options.channels);
    Projection projection = project(headlight_source(result.headlight, options.delta_m), planes,
                                    {options.refine, progress});
    result.figures = projection.figures;
    result.lightfield.slabs.push_back(std::move(projection.slab));
    result.lightfield.provenance = provenance_of(options);
    auto& figures = result.lightfield.provenance.figures;
    figures = {{"flux_formula_lm", result.figures.flux_lm},
               {"flux_lightfield_lm", model::luminance(model::flux(result.lightfield))},
               {"quadrature_error_rel", result.figures.quadrature_error},
               {"negative_share_rel", result.figures.negative_share},
               {"rescaled_share_rel", result.figures.rescaled_share}};
    for (const double distance_m : {1.0, 10.0}) {
        const WallError error = wall_error(
            wall_points(result.headlight, result.lightfield, distance_m, kWallPoints), distance_m);
        const std::string wall = fmt::format("wall_{:g}m_", distance_m);
        figures.emplace_back(wall + "median_rel", error.median_rel);
        figures.emplace_back(wall + "p95_rel", error.p95_rel);
        figures.emplace_back(wall + "max_of_peak", error.max_of_peak);
        result.walls.push_back(error);
    }
    return result;
}

LightField simulate_reference() {
    LightField lightfield = make_reference_lamp();
    lightfield.provenance.program = program_version();
    lightfield.provenance.command = "simulate";
    lightfield.provenance.options = {{"lamp", "reference"}};
    return lightfield;
}

std::string receivers_csv() {
    std::string text = std::string(kPointColumns) + "\n";
    for (const model::Receiver& receiver : reference_receivers()) {
        const glm::dvec3 p = receiver.position_m, n = receiver.normal;
        text += fmt::format("{},{},{},{},{},{}\n", p.x, p.y, p.z, n.x, n.y, n.z);
    }
    return text;
}

}  // namespace nearfield::sample_data
