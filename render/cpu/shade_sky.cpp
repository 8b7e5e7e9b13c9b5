// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/shade_sky.h"

#include "formats/shared/brdf_weight.glsl.h"
#include "formats/shared/filtered_samples.glsl.h"
#include "formats/shared/sample_count.glsl.h"
#include "formats/shared/spherical_harmonics.glsl.h"
#include "formats/shared/suns.glsl.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/sky_filter.h"

#include <algorithm>
#include <optional>

namespace nearfield::render {
namespace {

/// Cosine times what of the sky is hidden, where any of the directions that were asked for is.
std::optional<environment::HarmonicValues> hidden_sky(const SkyQuery& query, Scratch& scratch) {
    if (!query.shade.has_shadows)
        return std::nullopt;
    const environment::VisibilityFit& asked = *query.sky.environment->directions;
    const glm::mat3 world_from_sky = glm::transpose(query.sky.environment_from_world);
    std::vector<float> hidden(asked.directions.size(), 0.0F);
    bool is_any = false;
    for (std::size_t n = 0; n < hidden.size(); ++n) {
        const glm::vec3 world = world_from_sky * asked.directions[n];
        const float cosine = glm::dot(query.shade.frame.z, world);
        if (cosine > 0.0F && !is_open(query, world, scratch)) {
            hidden[n] = cosine;
            is_any = true;
        }
    }
    if (!is_any)
        return std::nullopt;
    return environment::harmonics_of(asked, hidden);
}

/// Share of a direction's light that arrives: the harmonics hold a cosine, which lobes have
/// already.
float visible_share(const environment::HarmonicValues& hidden, glm::vec3 direction, float cosine) {
    return 1.0F - std::clamp(environment::value_of(hidden, direction) /
                                 std::max(cosine, shared::kLeastHiddenCosine),
                             0.0F, 1.0F);
}

using Hidden = std::optional<environment::HarmonicValues>;

float visible_share(const Hidden& hidden, glm::vec3 direction, float cosine) {
    return hidden ? visible_share(*hidden, direction, cosine) : 1.0F;
}

/// The lobe's mean of one of the maps, roughly, and that of luminance squared.
glm::vec4 mean_over_lobe(const environment::ParaboloidMap& map, glm::vec3 axis, float lobe_sr) {
    const float texels =
        shared::texels_per_sample(static_cast<float>(map.texels()), 1.0F, 1.0F / lobe_sr,
                                  shared::paraboloid_sr_per_area(axis));
    return environment::filtered_with_square(map, axis,
                                             shared::filter_level(shared::kLevelMfis, texels));
}

/// How many filtered samples the options call for. share: of suns, in maps.
int sample_count(const SkyQuery& query, float share) {
    const EnvironmentOptions& options = query.options;
    if (!(options.error_rel > 0.0))
        return options.samples;
    const environment::Environment& around = *query.sky.environment;
    const glm::vec3 to_viewer = to_viewer_local(query.shade);
    const float lobe_sr = shared::brdf_lobe_solid_angle_sr(query.shade.brdf, to_viewer);
    if (!(lobe_sr > 0.0F))
        return options.samples;
    const glm::vec3 axis = query.sky.local(shared::world_from_local(
        query.shade.frame, shared::brdf_lobe_axis(query.shade.brdf, to_viewer)));
    glm::vec4 mean(0.0F);
    if (share < 1.0F)
        mean += (1.0F - share) * mean_over_lobe(*around.maps, axis, lobe_sr);
    if (share > 0.0F)
        mean += share * mean_over_lobe(*around.maps_with_suns, axis, lobe_sr);
    return shared::filtered_sample_count(
        shared::relative_variance(shared::luminance709(glm::vec3(mean)), mean.w),
        shared::independent_looks(query.turn_rad, lobe_sr, query.camera_samples),
        static_cast<float>(options.error_rel), options.samples);
}

/// What a lobe reflects of one of the maps: the mean over its samples.
glm::vec3 filtered_gloss(const SkyQuery& query,
                         const environment::ParaboloidMap& map,
                         int samples,
                         const Hidden& hidden) {
    const ShadeQuery& shade = query.shade;
    const SkyLobe lobe{map, shade.brdf, shade.frame, query.sky.environment_from_world,
                       to_viewer_local(shade)};
    const glm::vec2 shift = query.options.is_shifted
                                ? shift_of_set(shade, 0, shade.seed ^ kFilteredSeed)
                                : glm::vec2(0.0F);
    const auto count = static_cast<shared::uint>(samples);
    glm::vec3 sum(0.0F);
    for (shared::uint i = 0; i < count; ++i) {
        const glm::vec2 xi = glm::fract(shared::hammersley_point(i, count) + shift);
        const glm::vec3 to_light = shared::brdf_lobe_sample(shade.brdf, lobe.to_viewer, xi);
        const float density = shared::brdf_lobe_density(shade.brdf, to_light, lobe.to_viewer);
        if (!(density > 0.0F))
            continue;
        sum += filtered_light(lobe, query.options, samples, xi, to_light, density) *
               shared::brdf_lobe_weight(shade.brdf, to_light, lobe.to_viewer) *
               visible_share(hidden, lobe.in_environment(to_light), to_light.z);
    }
    return sum / static_cast<float>(count);
}

/// Light of the suns, as points: irradiance, and what the lobe reflects of it.
LampLight sun_light(const SkyQuery& query, const Hidden& hidden) {
    const glm::mat3 world_from_sky = glm::transpose(query.sky.environment_from_world);
    const glm::vec3 to_viewer = to_viewer_local(query.shade);
    LampLight light;
    for (const environment::Sun& sun : query.sky.environment->suns->suns) {
        const glm::vec3 to_light =
            shared::local_from_world(query.shade.frame, world_from_sky * sun.direction);
        if (!shared::brdf_is_above(to_light))
            continue;
        const glm::vec3 arriving =
            sun.irradiance * to_light.z * visible_share(hidden, sun.direction, to_light.z);
        light.irradiance += arriving;
        if (shared::brdf_is_glossy(query.shade.brdf))
            light.radiance += arriving * shared::brdf_lobe(query.shade.brdf, to_light, to_viewer);
    }
    return light;
}

/// What a lobe reflects of the sky without suns, and of these what the maps show of them. share: of
/// suns, in maps.
glm::vec3 filtered_gloss(const SkyQuery& query,
                         float share,
                         const Hidden& hidden,
                         Scratch& scratch) {
    const environment::Environment& around = *query.sky.environment;
    const int samples = sample_count(query, share);
    scratch.sky_samples += static_cast<std::uint64_t>(samples);
    glm::vec3 sum(0.0F);
    if (share < 1.0F)
        sum += (1.0F - share) * filtered_gloss(query, *around.maps, samples, hidden);
    if (share > 0.0F)
        sum += share * filtered_gloss(query, *around.maps_with_suns, samples, hidden);
    return sum;
}

/// Irradiance by harmonics, less what is hidden.
glm::vec3 filtered_irradiance(const SkyQuery& query, const Hidden& hidden) {
    const environment::Harmonics& sky = *query.sky.environment->harmonics;
    glm::vec3 sum = environment::irradiance(sky, query.sky.local(query.shade.frame.z));
    if (hidden)
        for (std::size_t k = 0; k < hidden->size(); ++k)
            sum -= sky.radiance.at(k) * hidden->at(k);
    return glm::max(sum, 0.0F);
}

}  // namespace

bool is_open(const SkyQuery& query, glm::vec3 direction_world, Scratch& scratch) {
    if (!query.shade.has_shadows)
        return true;
    const Hit& hit = query.shade.hit;
    const glm::dvec3 direction(direction_world);
    if (!(glm::dot(direction, hit.geometric_normal) > 0.0))
        return false;
    ++scratch.shadow_rays;
    return query.tracer.is_open(hit.position_world_m + hit.geometric_normal * hit.offset_m,
                                direction);
}

LampLight shade_sky_filtered(const SkyQuery& query, Scratch& scratch) {
    const environment::Environment& around = *query.sky.environment;
    const Hidden hidden = hidden_sky(query, scratch);
    const LampLight suns = around.suns ? sun_light(query, hidden) : LampLight{};
    LampLight light;
    if (around.harmonics) {
        light.irradiance =
            query.sky.intensity * (filtered_irradiance(query, hidden) + suns.irradiance);
        light.radiance = light.irradiance * diffuse_of(query.shade);
    }
    if (around.maps && shared::brdf_is_glossy(query.shade.brdf)) {
        const float share =
            around.suns ? shared::suns_in_maps(shared::brdf_lobe_width_rad(
                                                   query.shade.brdf, to_viewer_local(query.shade)),
                                               around.suns->radius_rad)
                        : 0.0F;
        light.radiance += query.sky.intensity * (filtered_gloss(query, share, hidden, scratch) +
                                                 (1.0F - share) * suns.radiance);
    }
    return light;
}

LampLight shade_sky_lights(const SkyQuery& query, Scratch& scratch) {
    const environment::VisibilityFit& lamps = *query.sky.environment->directions;
    const glm::mat3 world_from_sky = glm::transpose(query.sky.environment_from_world);
    const glm::vec3 to_viewer = to_viewer_local(query.shade);
    LampLight light;
    for (std::size_t n = 0; n < lamps.directions.size(); ++n) {
        const glm::vec3 world = world_from_sky * lamps.directions[n];
        const glm::vec3 to_light = shared::local_from_world(query.shade.frame, world);
        if (!shared::brdf_is_above(to_light) || !is_open(query, world, scratch))
            continue;
        const glm::vec3 arriving = lamps.light[n] * (to_light.z * query.sky.intensity);
        light.irradiance += arriving;
        light.radiance += arriving * shared::brdf_eval(query.shade.brdf, to_light, to_viewer);
    }
    return light;
}

}  // namespace nearfield::render
