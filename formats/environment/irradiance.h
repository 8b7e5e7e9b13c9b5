// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/latlong.h"

#include <array>

namespace nearfield::environment {

/// Irradiance on a surface of every orientation as spherical harmonics up to l = 2 (Ramamoorthi and
/// Hanrahan, "An efficient representation for irradiance environment maps", 2001).
struct IrradianceHarmonics {
    std::array<glm::vec3, 9> coefficients{};  // of irradiance, index l (l + 1) + m
};

/// Projects radiance, pixel by pixel in double, and multiplies by the cosine's factors.
IrradianceHarmonics project_irradiance(const LatLong& picture);

/// E(normal) / radiance's unit, >= 0: what l > 2 would add is missing (at worst 6 % of what a
/// single sun gives a surface that faces it, and 6 % of that where it should give none), and what
/// falls below 0 by that is 0.
glm::vec3 irradiance(const IrradianceHarmonics& harmonics, glm::vec3 normal);

/// The same by the sum over all pixels, visible or not above the surface's plane: the reference.
/// Cost  O(pixels).
glm::dvec3 direct_irradiance(const LatLong& picture, glm::dvec3 normal);

}  // namespace nearfield::environment
