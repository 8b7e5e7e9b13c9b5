// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/latlong.h"

#include <array>

namespace nearfield::environment {

/// Light from all directions on the six faces of a cube with mips, each face by itself: what
/// paraboloid maps are measured against (`bench environment`). No renderer reads it.
struct CubeMap {
    struct Level {
        int side_px = 0;
        std::array<std::vector<glm::vec3>, 6> faces;  // +x -x +y -y +z -z, [row][column]
    };
    std::vector<Level> levels;  // the finest first, each half as wide as the one before, to 1 x 1

    int side_px() const { return levels.front().side_px; }
    double texels() const { return static_cast<double>(side_px()) * side_px(); }  // of one face
};

/// Means of the picture over texels, by 4 x 4 points in each; then over 2 x 2, level by level.
/// side_px: a power of two, or an Error.
CubeMap make_cube_map(const LatLong& picture, int side_px);

/// Linear between the texels of one face, and between levels; beyond a face's border its own texels
/// are continued. direction: of unit length.
glm::vec3 filtered(const CubeMap& map, glm::vec3 direction, float level);

/// Solid angle per area of a face, [0, 1]^2: with (u, v) in -1 ... 1 on the face d omega = du dv
/// (1 + u^2 + v^2)^(-3/2), whose root is the direction's largest component.
double cube_sr_per_area(glm::vec3 direction);

}  // namespace nearfield::environment
