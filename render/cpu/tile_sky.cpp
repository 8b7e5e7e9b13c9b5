// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/shade_sky.h"
#include "render/cpu/tile_block.h"

#include <cmath>

namespace nearfield::render {
namespace {

/// Adds radiance of the environment to the picture and to its own layer.
void add_sky(const Frame& frame, std::size_t pixel, glm::vec3 radiance, float share) {
    add_rgb(frame.picture.layers[kRadiance], pixel, radiance * share);
    add_rgb(frame.picture.layers[*frame.environment_layer], pixel, radiance * share);
}

LampLight shade_sky(const SkyQuery& query, Scratch& scratch) {
    switch (query.options.method) {
        case EnvironmentMethod::Lights:
            return shade_sky_lights(query, scratch);
        case EnvironmentMethod::Resampled:
            return shade_sky_resampled(query, scratch);
        case EnvironmentMethod::Reference:
            return shade_sky_reference(query, scratch);
        default:
            return shade_sky_filtered(query, scratch);
    }
}

/// How far the normal turns across a pixel, radians: towards the viewer, as if it were not slanted.
float turn_of(const Frame& frame, const Hit& hit) {
    const glm::dvec3 eye(frame.camera.world_from_camera[3]);
    const glm::dvec3 forward = -glm::normalize(glm::dvec3(frame.camera.world_from_camera[2]));
    const double px_per_unit =
        0.5 * frame.picture.size_px.y / std::tan(0.5 * frame.camera.yfov_rad);
    return static_cast<float>(frame.tracer.curvature(hit) *
                              glm::dot(hit.position_world_m - eye, forward) / px_per_unit);
}

}  // namespace

void add_sky_past(const Frame& frame, std::size_t pixel, glm::dvec3 direction, float share) {
    if (frame.sky != nullptr)
        add_sky(frame, pixel, radiance_from(*frame.sky, glm::vec3(direction)), share);
}

void shade_sky_block(const Frame& frame, const Pass& pass, int stratum, Block& block) {
    const int strata = frame.strata * frame.strata;
    const auto first_set =
        (pass.index * static_cast<std::uint32_t>(strata) + static_cast<std::uint32_t>(stratum)) *
        static_cast<std::uint32_t>(kMostSets);
    const float share = pass.weight / static_cast<float>(strata);
    const bool has_turns = counts_by_turns(frame.plan, frame.options);
    for (std::size_t k = 0; k < block.samples.size(); ++k) {
        ShadeQuery query = query_of(frame, pass, block, k, first_set);
        query.has_shadows = hides_sky(frame.plan);
        const float turn_rad = has_turns ? turn_of(frame, block.hits[k]) : 0.0F;
        const LampLight light =
            shade_sky({*frame.sky, frame.tracer, query, frame.options.environment, turn_rad,
                       static_cast<float>(strata)},
                      block.scratch);
        const std::size_t index = block.samples[k].index;
        add_sky(frame, index, light.radiance, share);
        add_rgb(frame.picture.layers[kIrradiance], index, light.irradiance * share);
        frame.picture.layers[kSigma].values[index] += light.variance_y * share * share;
    }
}

}  // namespace nearfield::render
