// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/irradiance.h"

#include "formats/shared/spherical_harmonics.glsl.h"

#include <algorithm>

namespace nearfield::environment {
namespace {

/// Calls with the direction to each pixel, and its radiance times its solid angle.
template <typename Add>
void for_each_pixel(const LatLong& picture, const Add& add) {
    for (int y = 0; y < picture.size_px.y; ++y) {
        const double sr = pixel_sr(picture, y);
        for (int x = 0; x < picture.size_px.x; ++x)
            add(pixel_direction(picture, {x, y}),
                sr * glm::dvec3(picture.radiance[picture.index({x, y})]));
    }
}

}  // namespace

IrradianceHarmonics project_irradiance(const LatLong& picture) {
    std::array<glm::dvec3, shared::kHarmonicsOfIrradiance> sums{};
    for_each_pixel(picture, [&](glm::vec3 direction, glm::dvec3 light) {
        for (int k = 0; k < shared::kHarmonicsOfIrradiance; ++k)
            sums.at(static_cast<std::size_t>(k)) +=
                static_cast<double>(shared::harmonic(k, direction)) * light;
    });
    IrradianceHarmonics result;
    for (int k = 0; k < shared::kHarmonicsOfIrradiance; ++k)
        result.coefficients.at(static_cast<std::size_t>(k)) =
            sums.at(static_cast<std::size_t>(k)) * static_cast<double>(shared::cosine_factor(k));
    return result;
}

glm::vec3 irradiance(const IrradianceHarmonics& harmonics, glm::vec3 normal) {
    glm::vec3 sum(0.0F);
    for (int k = 0; k < shared::kHarmonicsOfIrradiance; ++k)
        sum += harmonics.coefficients.at(static_cast<std::size_t>(k)) * shared::harmonic(k, normal);
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
