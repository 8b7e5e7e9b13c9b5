// SPDX-License-Identifier: Apache-2.0
/// Small environments by formula, and sums over the sphere that share nothing with what is tested.
#pragma once

#include "formats/environment/latlong.h"

#include <glm/glm.hpp>

#include <functional>

namespace nearfield::test {

/// Radiance by direction, at pixels' middles.
environment::LatLong sky(int height_px, const std::function<glm::vec3(glm::dvec3)>& radiance);

/// A dark blue sky over brown ground, a wide glow, and one pixel of 2e4: 20,000 times its mean.
environment::LatLong sunny_sky(int height_px);

/// A gray picture, 0 but for one pixel.
environment::LatLong lone_sun(int height_px, glm::ivec2 pixel, float radiance);

/// Integral over the sphere by the midpoint rule in azimuth and in the cosine of the polar angle
/// about z, 2 n x n points.
double over_sphere(int n, const std::function<double(glm::dvec3)>& value);

}  // namespace nearfield::test
