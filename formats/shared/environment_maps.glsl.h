// SPDX-License-Identifier: Apache-2.0
// Where the light of a direction stands in pictures of all directions.
//
// Directions have unit length. In a latitude-longitude picture the first row is +y, the last -y,
// the middle column -z, and +x is to the right of it: what a camera with an identity matrix sees.
#ifndef NEARFIELD_ENVIRONMENT_MAPS_GLSL_H
#define NEARFIELD_ENVIRONMENT_MAPS_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

const float kTurn = 6.28318531f;  // radians

// Position in the picture, x to the right and y down, both in [0, 1].
GPU_FN vec2 latlong_from_direction(vec3 direction) {
    float azimuth = atan(direction.x, -direction.z);  // -pi ... pi
    float across = sqrt(direction.x * direction.x + direction.z * direction.z);
    float polar = atan(across, direction.y);  // 0 at +y ... pi; acos would lose the poles' digits
    return vec2(0.5f + azimuth / kTurn, 2.0f * polar / kTurn);
}

GPU_FN vec3 direction_from_latlong(vec2 at) {
    float azimuth = (at.x - 0.5f) * kTurn;
    float polar = at.y * 0.5f * kTurn;
    float across = sin(polar);
    return vec3(across * sin(azimuth), cos(polar), -across * cos(azimuth));
}

// Scaled dual paraboloids: each of two square maps shows the directions of one half space (z >= 0,
// z < 0) by their stereographic projection, and by b = 1.2 more than that, so that coarser levels
// know what lies beyond the seam (Colbert and Krivanek, "GPU-based importance sampling", GPU Gems
// 3, 2007, section 20.4.1; after Heidrich and Seidel 1998).
const float kParaboloidScale = 1.2f;

struct ParaboloidPoint {
    int side;  // 0: z >= 0, 1: z < 0
    vec2 at;   // position in that side's map, [0, 1]^2
};

GPU_FN ParaboloidPoint paraboloid_from_direction(vec3 direction) {
    ParaboloidPoint point;
    point.side = direction.z >= 0.0f ? 0 : 1;
    float scale = 0.5f / (kParaboloidScale * (1.0f + abs(direction.z)));
    point.at = vec2(0.5f + direction.x * scale, 0.5f + direction.y * scale);
    return point;
}

// Of the whole map, with what it shows of the other half space.
GPU_FN vec3 direction_from_paraboloid(int side, vec2 at) {
    float x = (2.0f * at.x - 1.0f) * kParaboloidScale;
    float y = (2.0f * at.y - 1.0f) * kParaboloidScale;
    float square = x * x + y * y;
    float z = (1.0f - square) / (1.0f + square);
    return vec3(x * (1.0f + z), y * (1.0f + z), side == 0 ? z : -z);
}

// Solid angle per area of its map, of a direction in its own half space: with X = x/(1 + |z|) it is
// d omega = (1 + |z|)^2 dX dY, and dX = 2 b ds.
GPU_FN float paraboloid_sr_per_area(vec3 direction) {
    float stretch = 2.0f * kParaboloidScale * (abs(direction.z) + 1.0f);
    return stretch * stretch;
}

SHARED_END

#endif
