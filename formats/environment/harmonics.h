// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/latlong.h"

#include <array>

namespace nearfield::environment {

/// Radiance as spherical harmonics up to l = 3 (formats/shared/spherical_harmonics.glsl.h).
struct Harmonics {
    std::array<glm::vec3, 16> radiance{};  // index l (l + 1) + m
};

/// Pixel by pixel, in double.
Harmonics project(const LatLong& picture);

/// Irradiance on a surface of this normal, >= 0 (Ramamoorthi and Hanrahan, "An efficient
/// representation for irradiance environment maps", 2001): what l > 3 would add is missing, and
/// what falls below 0 by that is 0. Of a single sun, the worst case, in shares of what a surface
/// that faces it receives: 1/16 too much there, 3/32 where the sun is on the horizon and should
/// give none.
glm::vec3 irradiance(const Harmonics& harmonics, glm::vec3 normal);

/// The same by the sum over all pixels before the surface's plane: the reference.
/// Cost  O(pixels).
glm::dvec3 direct_irradiance(const LatLong& picture, glm::dvec3 normal);

}  // namespace nearfield::environment
