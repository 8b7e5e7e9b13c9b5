// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/latlong.h"

#include <array>

namespace nearfield::environment {

/// Light from all directions on two square maps with mips (environment_maps.glsl.h): what filtered
/// samples are read from.
struct ParaboloidMap {
    struct Level {
        int side_px = 0;
        // r g b, and the mean of luminance squared: [z >= 0, z < 0][row of y][column of x]
        std::array<std::vector<glm::vec4>, 2> sides;
    };
    std::vector<Level> levels;  // the finest first, each half as wide as the one before, to 1 x 1

    int side_px() const { return levels.front().side_px; }
    double texels() const { return static_cast<double>(side_px()) * side_px(); }  // of one map
};

/// The side, a power of two, at which no texel spans more than one of the picture's pixels at its
/// equator.
int side_for(const LatLong& picture);

/// Means of the picture over texels, by 4 x 4 points in each; then over 2 x 2 texels, level by
/// level.
///
/// side_px  a power of two; 0: side_for(picture)
/// Error    light that arrives through the map, relative: docs/environments.md
/// Cost     32 lookups for each texel of the finest level; parallel (TBB). Memory 32 bytes a
/// texel.
ParaboloidMap make_paraboloid_map(const LatLong& picture, int side_px = 0);

/// The map's value at a direction of unit length: linear between texels, and between levels. level
/// is clamped to those that there are.
glm::vec4 filtered_with_square(const ParaboloidMap& map, glm::vec3 direction, float level);

/// r g b of it.
glm::vec3 filtered(const ParaboloidMap& map, glm::vec3 direction, float level);

}  // namespace nearfield::environment
