// SPDX-License-Identifier: Apache-2.0
// A surface's local frame: z its shading normal, x its tangent, all of unit length.
#ifndef NEARFIELD_FRAME_GLSL_H
#define NEARFIELD_FRAME_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

struct SurfaceFrame {
    vec3 x;
    vec3 y;
    vec3 z;
};

// Some right-handed frame about a normal of unit length, the same one on every machine. It jumps
// where normal.z changes its sign. Duff et al., "Building an orthonormal basis, revisited", JCGT
// 6(1), 2017.
GPU_FN SurfaceFrame frame_from_normal(vec3 normal) {
    float side = normal.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / (side + normal.z);
    float b = normal.x * normal.y * a;
    SurfaceFrame frame;
    frame.x = vec3(1.0f + side * normal.x * normal.x * a, side * b, -side * normal.x);
    frame.y = vec3(b, side + normal.y * normal.y * a, -normal.y);
    frame.z = normal;
    return frame;
}

// The right-handed frame whose x is the tangent's part across the normal. A tangent of any length;
// where it is parallel to the normal, or 0: frame_from_normal.
GPU_FN SurfaceFrame frame_from_tangent(vec3 normal, vec3 tangent) {
    vec3 across = tangent - normal * dot(normal, tangent);
    float square = dot(across, across);
    // What rounding leaves of a parallel one is 1e-7 of its length.
    if (!(square > 1e-10f * dot(tangent, tangent)))
        return frame_from_normal(normal);
    SurfaceFrame frame;
    frame.x = across * inversesqrt(square);
    frame.y = cross(normal, frame.x);
    frame.z = normal;
    return frame;
}

GPU_FN vec3 local_from_world(SurfaceFrame frame, vec3 direction) {
    return vec3(dot(frame.x, direction), dot(frame.y, direction), dot(frame.z, direction));
}

GPU_FN vec3 world_from_local(SurfaceFrame frame, vec3 direction) {
    return frame.x * direction.x + frame.y * direction.y + frame.z * direction.z;
}

SHARED_END

#endif
