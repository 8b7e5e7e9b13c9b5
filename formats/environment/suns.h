// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/latlong.h"

#include <vector>

namespace nearfield::environment {

/// A small bright part of a picture, as a far lamp.
struct Sun {
    glm::vec3 direction{0.0F, 1.0F, 0.0F};  // the middle of its light
    glm::vec3 irradiance{0.0F};             // on a surface that faces it
};

struct Suns {
    std::vector<Sun> suns;    // the brightest pixel's first
    float radius_rad = 0.0F;  // of the largest, a pixel's diagonal included
    LatLong rest;             // the picture without their light
};

/// Takes what is brighter than 8 times the picture's mean, no farther than 1.5 degrees (or a
/// pixel's diagonal) from the brightest pixel that is left, into one sun after another, `most` at
/// most. Only what goes beyond 8 times the mean: of the rest no pixel that a sun has is brighter.
///
/// Error  none of light: suns and rest are the picture's, but for rounding
/// Cost   O(bright pixels x suns)
Suns take_suns(const LatLong& picture, int most);

}  // namespace nearfield::environment
