// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/draw.glsl.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/shade_sky.h"

#include <algorithm>
#include <vector>

namespace nearfield::render {
namespace {

// Shifts of the sky's samples, of the BRDF's among them and of the choice between lobe and diffuse
// part are independent of lamps' and lobes'.
constexpr std::uint32_t kSkySeed = 0x7f4a7c15U, kSkyBrdfSeed = 0x94d049bbU,
                        kSkyChoiceSeed = 0xbf58476dU;

/// A direction drawn by luminance or by the BRDF; as many are drawn either way.
struct SkyDirection {
    glm::vec3 world{0.0F}, to_light{0.0F};
    glm::vec3 radiance{0.0F};
    float densities = 0.0F;  // of both ways, added; 0: the direction is worth nothing
};

/// sky_density: of the pixel that radiance is of. Asked for by the direction again, one at a sun's
/// border might be taken for its dark neighbor's, and weigh thousands of times too much.
SkyDirection sky_direction(const SkyQuery& query,
                           glm::vec3 world,
                           glm::vec3 radiance,
                           float sky_density) {
    SkyDirection direction{world, shared::local_from_world(query.shade.frame, world), radiance,
                           0.0F};
    if (shared::brdf_is_above(direction.to_light))
        direction.densities =
            sky_density + shared::brdf_density(query.shade.brdf, direction.to_light,
                                               to_viewer_local(query.shade));
    return direction;
}

/// `count` directions drawn in each way, in turn, of one set.
std::vector<SkyDirection> draw_directions(const SkyQuery& query, int set, int count) {
    const ShadeQuery& shade = query.shade;
    const auto words = [&](std::uint32_t seed) {
        return shared::shift_words(shift_of_set(shade, set, shade.seed ^ seed));
    };
    const glm::uvec2 sky_words = words(kSkySeed), brdf_words = words(kSkyBrdfSeed);
    const std::uint32_t choice_word = words(kSkyChoiceSeed).x;
    const glm::mat3 world_from_sky = glm::transpose(query.sky.environment_from_world);
    const environment::LatLong& picture = query.sky.environment->picture;
    const glm::vec3 to_viewer = to_viewer_local(shade);
    std::vector<SkyDirection> directions;
    for (int k = 0; k < count; ++k) {
        const auto q = static_cast<std::uint32_t>(k);
        const environment::SkySample drawn =
            environment::draw(*query.sky.environment->table, shared::r2_point(q, sky_words));
        if (drawn.density > 0.0F)
            directions.push_back(sky_direction(query, world_from_sky * drawn.direction,
                                               picture.radiance[picture.index(drawn.pixel)],
                                               drawn.density));
        const glm::vec2 xi = shared::r2_point(q, brdf_words);
        const float choice = shared::unit_float(shared::golden_word(q) + choice_word);
        const glm::vec3 world = shared::world_from_local(
            shade.frame, shared::brdf_sample(shade.brdf, to_viewer, glm::vec3(xi, choice)));
        const glm::vec3 in_sky = query.sky.local(world);
        directions.push_back(
            sky_direction(query, world, environment::radiance(picture, in_sky),
                          environment::density(*query.sky.environment->table, in_sky)));
    }
    return directions;
}

/// The light of a direction, times a weight, where it is visible.
void add_light(const SkyQuery& query,
               const SkyDirection& direction,
               double weight,
               Scratch& scratch,
               SetSums& sums) {
    if (!is_open(query, direction.world, scratch))
        return;
    const glm::dvec3 light = glm::dvec3(direction.radiance) * weight;
    sums.lit += light;
    if (shared::brdf_is_glossy(query.shade.brdf))
        sums.reflected += light * glm::dvec3(shared::brdf_lobe(query.shade.brdf, direction.to_light,
                                                               to_viewer_local(query.shade)));
}

/// From sets of samples, each the work of `sums_of(set, samples)`.
template <typename SumsOf>
LampLight light_of_sets(const SkyQuery& query, const SumsOf& sums_of) {
    const ShadeQuery& shade = query.shade;
    std::vector<SetSums> sets;
    for (int set = 0; set < shade.sets.sets; ++set) {
        sets.push_back(sums_of(set, shade.sets.size_of(set)));
        sets.back().count = shade.sets.size_of(set);
    }
    const Estimated estimate = combine_means(sets, glm::dvec3(diffuse_of(shade)));
    const float intensity = query.sky.intensity;
    LampLight light;
    light.irradiance = glm::vec3(estimate.irradiance) * intensity;
    light.radiance = glm::vec3(estimate.radiance) * intensity;
    light.variance_y = static_cast<float>(estimate.variance_y) * intensity * intensity;
    return light;
}

/// Running sums of what each direction would reflect if it were visible, in luminance, over its
/// density.
std::vector<double> running_sums(const SkyQuery& query, const std::vector<SkyDirection>& from) {
    std::vector<double> sums;
    double sum = 0.0;
    for (const SkyDirection& one : from) {
        if (one.densities > 0.0F)
            sum += static_cast<double>(
                shared::luminance709(one.radiance *
                                     shared::brdf_eval(query.shade.brdf, one.to_light,
                                                       to_viewer_local(query.shade))) *
                one.to_light.z / one.densities);
        sums.push_back(sum);
    }
    return sums;
}

}  // namespace

LampLight shade_sky_reference(const SkyQuery& query, Scratch& scratch) {
    return light_of_sets(query, [&](int set, int samples) {
        SetSums sums;
        for (const SkyDirection& direction : draw_directions(query, set, samples))
            if (direction.densities > 0.0F)
                add_light(query, direction,
                          static_cast<double>(direction.to_light.z / direction.densities), scratch,
                          sums);
        return sums;
    });
}

LampLight shade_sky_resampled(const SkyQuery& query, Scratch& scratch) {
    constexpr int kCandidates = 8;
    return light_of_sets(query, [&](int set, int samples) {
        const int each_way = samples * kCandidates / 2;
        const std::vector<SkyDirection> candidates = draw_directions(query, set, each_way);
        const std::vector<double> rises = running_sums(query, candidates);
        SetSums sums;
        const double whole = rises.empty() ? 0.0 : rises.back();
        if (!(whole > 0.0))
            return sums;
        const double first =
            static_cast<double>(shift_of_set(query.shade, set, query.shade.seed ^ ~kSkySeed).x);
        for (int k = 0; k < samples; ++k) {
            const auto at =
                std::upper_bound(rises.begin(), rises.end(), whole * (k + first) / samples) -
                rises.begin();
            const auto chosen = std::min(static_cast<std::size_t>(at), candidates.size() - 1);
            const double step = rises[chosen] - (chosen > 0 ? rises[chosen - 1] : 0.0);
            if (!(step > 0.0))
                continue;
            // A candidate's own weight over the chance that it is chosen by.
            const SkyDirection& one = candidates[chosen];
            const double weight =
                static_cast<double>(one.to_light.z / one.densities) * whole / (step * each_way);
            add_light(query, one, weight, scratch, sums);
        }
        return sums;
    });
}

}  // namespace nearfield::render
