// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/sky_filter.h"

#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/filtered_samples.glsl.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

shared::uint shared_level(FilterLevel level) {
    switch (level) {
        case FilterLevel::Gems:
            return shared::kLevelGems;
        case FilterLevel::None:
            return shared::kLevelNone;
        default:
            return shared::kLevelFis;
    }
}

/// The ellipse on the map that a sample's share of [0, 1)^2 becomes, by differences: half axes in
/// units of the map.
struct Footprint {
    glm::vec2 x{0.0F}, y{0.0F};
};

Footprint footprint(const SkyLobe& lobe, int count, glm::vec2 xi, glm::vec3 direction) {
    const shared::ParaboloidPoint middle = shared::paraboloid_from_direction(direction);
    const float half_side = 0.5F / std::sqrt(static_cast<float>(count));
    const auto half_axis = [&](glm::vec2 step) {
        // Towards the middle of [0, 1)^2, so that no point leaves it.
        const glm::vec2 turned = glm::mix(step, -step, glm::greaterThan(xi, glm::vec2(0.5F)));
        const glm::vec3 moved = lobe.in_environment(
            shared::brdf_lobe_sample(lobe.brdf, lobe.to_viewer, xi + turned * half_side));
        // On the same side's map, beyond its seam too.
        const float z = middle.side == 0 ? moved.z : -moved.z;
        const float scale = 0.5F / (shared::kParaboloidScale * std::max(1.0F + z, 0.1F));
        return 0.5F + glm::vec2(moved) * scale - middle.at;
    };
    return {half_axis({1.0F, 0.0F}), half_axis({0.0F, 1.0F})};
}

/// Lookups along the longer axis, as wide as the shorter: what graphics cards do.
glm::vec3 anisotropic(const SkyLobe& lobe, int count, glm::vec2 xi, glm::vec3 direction) {
    constexpr int kMost = 16;
    Footprint axes = footprint(lobe, count, xi, direction);
    if (glm::length(axes.x) < glm::length(axes.y))
        std::swap(axes.x, axes.y);
    const float longer = glm::length(axes.x);
    const float shorter = std::max(glm::length(axes.y), longer / float{kMost});
    const int taps = longer > 0.0F ? static_cast<int>(std::ceil(longer / shorter)) : 1;
    const float level =
        std::log2(std::max(2.0F * shorter * static_cast<float>(lobe.map.side_px()), 1.0F));
    const shared::ParaboloidPoint middle = shared::paraboloid_from_direction(direction);
    glm::vec3 sum(0.0F);
    for (int k = 0; k < taps; ++k) {
        const float along = (2.0F * static_cast<float>(k) + 1.0F) / static_cast<float>(taps) - 1.0F;
        const glm::vec2 at = glm::clamp(middle.at + axes.x * along, 0.0F, 1.0F);
        sum += environment::filtered(lobe.map, shared::direction_from_paraboloid(middle.side, at),
                                     level);
    }
    return sum / static_cast<float>(taps);
}

}  // namespace

glm::vec3 filtered_light(const SkyLobe& lobe,
                         const EnvironmentOptions& options,
                         glm::vec2 xi,
                         glm::vec3 to_light,
                         float density) {
    const glm::vec3 direction = lobe.in_environment(to_light);
    if (options.is_anisotropic)
        return anisotropic(lobe, options.samples, xi, direction);
    const float texels = shared::texels_per_sample(static_cast<float>(lobe.map.texels()),
                                                   static_cast<float>(options.samples), density,
                                                   shared::paraboloid_sr_per_area(direction));
    return environment::filtered(lobe.map, direction,
                                 shared::filter_level(shared_level(options.level), texels));
}

}  // namespace nearfield::render
