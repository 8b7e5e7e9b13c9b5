// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/sky_table.h"

#include <array>
#include <span>

namespace nearfield::environment {

/// A function of direction as spherical harmonics up to l = 3, index l (l + 1) + m.
using HarmonicValues = std::array<float, 16>;

/// Few directions that hold most of the light, drawn by luminance at Hammersley's points, and what
/// makes of a function's values there its harmonics (Krivanek and Colbert 2008, section 5.2).
struct VisibilityFit {
    std::vector<glm::vec3> directions;  // [N], of unit length, in the picture's frame
    std::vector<glm::vec3> light;       // [N] radiance over (N density): as N far lamps
    std::vector<float> fit;             // [16][N]
};

/// Least squares with a ridge, in double: 16 values barely determine 16 coefficients, and where no
/// direction was drawn the function is taken as 0.
///
/// count  1 ... 16384
/// Cost   O(16^2 count)
VisibilityFit make_visibility_fit(const LatLong& picture, const SkyTable& table, int count);

HarmonicValues harmonics_of(const VisibilityFit& fit, std::span<const float> values);

/// The function's value, which may be below 0 beside steep changes.
float value_of(const HarmonicValues& harmonics, glm::vec3 direction);

}  // namespace nearfield::environment
