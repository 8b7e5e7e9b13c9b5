// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/sky_filter.h"

#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/filtered_samples.glsl.h"
#include "formats/shared/mean_density.glsl.h"
#include "render/sky.h"

namespace nearfield::render {
namespace {

glm::vec3 anisotropic(const SkyLobe& lobe, int count, glm::vec2 xi, glm::vec3 direction) {
    const shared::ParaboloidPoint middle = shared::paraboloid_from_direction(direction);
    const auto half_axis = [&](int axis) {
        const glm::vec2 beside = shared::beside_point(xi, axis, static_cast<float>(count));
        return shared::map_offset(middle, lobe.in_environment(shared::brdf_lobe_sample(
                                              lobe.brdf, lobe.to_viewer, beside)));
    };
    const shared::MapLookups lookups =
        shared::lookups_along(half_axis(0), half_axis(1), static_cast<float>(lobe.map.side_px()));
    glm::vec3 sum(0.0F);
    for (int k = 0; k < lookups.taps; ++k)
        sum += environment::filtered(lobe.map,
                                     shared::direction_from_paraboloid(
                                         middle.side, shared::lookup_at(middle.at, lookups, k)),
                                     lookups.level);
    return sum / static_cast<float>(lookups.taps);
}

}  // namespace

glm::vec3 filtered_light(const SkyLobe& lobe,
                         const EnvironmentOptions& options,
                         int samples,
                         glm::vec2 xi,
                         glm::vec3 to_light,
                         float density) {
    const glm::vec3 direction = lobe.in_environment(to_light);
    if (options.is_anisotropic)
        return anisotropic(lobe, samples, xi, direction);
    const auto count = static_cast<float>(samples);
    const float around = options.level == FilterLevel::Mfis
                             ? 1.0F / (count * shared::mfis_solid_angle_sr(lobe.brdf, to_light,
                                                                           lobe.to_viewer, count))
                             : density;
    const float texels =
        shared::texels_per_sample(static_cast<float>(lobe.map.texels()), count, around,
                                  shared::paraboloid_sr_per_area(direction));
    return environment::filtered(lobe.map, direction,
                                 shared::filter_level(word_of(options.level), texels));
}

}  // namespace nearfield::render
