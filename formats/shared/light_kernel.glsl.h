// SPDX-License-Identifier: Apache-2.0
// The light of a point on U that was drawn for a receiver.
//
// In C++ include formats/model/axis_window.h first: window.glsl.h has no guard there.
#ifndef NEARFIELD_LIGHT_KERNEL_GLSL_H
#define NEARFIELD_LIGHT_KERNEL_GLSL_H

#include "formats/shared/portable.glsl.h"
#ifndef __cplusplus
#include "formats/shared/window.glsl.h"
#endif

SHARED_BEGIN

// A point on U and the tangents of the ray to it.
struct AperturePoint {
    vec2 u_m;
    vec2 t;
};

// The point at coordinates e of both axes.
GPU_FN AperturePoint aperture_at(AxisView x, AxisView y, vec2 e) {
    AperturePoint at;
    at.u_m = vec2(u_of_e(x, e.x), u_of_e(y, e.y));
    at.t = vec2(t_of_e(x, e.x), t_of_e(y, e.y));
    return at;
}

// n . (t, -1): the receiver's cosine times the length of (t, -1); below 0 behind it.
GPU_FN float kernel_cosine(vec3 normal, vec2 t) {
    return normal.x * t.x + normal.y * t.y - normal.z;
}

// What multiplies C_m in the integral over t, delta^2 apart: Phi_m(u) times the cosine, with
// radiance weighting over (1 + |t|^2)^2.
GPU_FN float light_kernel(float basis, float cosine, vec2 t, bool has_radiance_weighting) {
    float r2 = 1.0f + dot(t, t);
    return has_radiance_weighting ? basis * cosine / (r2 * r2) : basis * cosine;
}

// From a density over u to one per solid angle from the receiver: R^3 / (delta + Delta), distance =
// delta + Delta.
GPU_FN float omega_per_u(vec2 t, float distance) {
    float r2 = distance * distance * (1.0f + dot(t, t));
    return r2 * sqrt(r2) / distance;
}

SHARED_END

#endif
