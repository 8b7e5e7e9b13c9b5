// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/harmonics.h"

#include "formats/shared/spherical_harmonics.glsl.h"

#include <algorithm>

namespace nearfield::environment {
namespace {

/// Calls with the direction to each pixel, and its radiance times its solid angle. Of small
/// pictures pixels are divided, so that there are 128 rows at least: functions bend within their
/// pixels.
template <typename Add>
void for_each_pixel(const LatLong& picture, const Add& add) {
    constexpr int kFewestRows = 128;
    const int parts = (kFewestRows + picture.size_px.y - 1) / picture.size_px.y;
    const LatLong finer{picture.size_px * parts, {}};
    for (int y = 0; y < finer.size_px.y; ++y) {
        const double sr = pixel_sr(finer, y);
        for (int x = 0; x < finer.size_px.x; ++x)
            add(pixel_direction(finer, {x, y}),
                sr * glm::dvec3(picture.radiance[picture.index({x / parts, y / parts})]));
    }
}

}  // namespace

Harmonics project(const LatLong& picture) {
    std::array<glm::dvec3, shared::kHarmonics> sums{};
    for_each_pixel(picture, [&](glm::vec3 direction, glm::dvec3 light) {
        for (int k = 0; k < shared::kHarmonics; ++k)
            sums.at(static_cast<std::size_t>(k)) +=
                static_cast<double>(shared::harmonic(k, direction)) * light;
    });
    Harmonics result;
    std::copy(sums.begin(), sums.end(), result.radiance.begin());
    return result;
}

glm::vec3 irradiance(const Harmonics& harmonics, glm::vec3 normal) {
    glm::vec3 sum(0.0F);
    for (int k = 0; k < shared::kHarmonicsOfIrradiance; ++k)
        sum += harmonics.radiance.at(static_cast<std::size_t>(k)) *
               (shared::cosine_factor(k) * shared::harmonic(k, normal));
    return glm::max(sum, 0.0F);
}

glm::dvec3 direct_irradiance(const LatLong& picture, glm::dvec3 normal) {
    glm::dvec3 sum(0.0);
    for_each_pixel(picture, [&](glm::vec3 direction, glm::dvec3 light) {
        sum += std::max(glm::dot(glm::dvec3(direction), normal), 0.0) * light;
    });
    return sum;
}

}  // namespace nearfield::environment
