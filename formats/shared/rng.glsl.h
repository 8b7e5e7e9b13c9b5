// SPDX-License-Identifier: Apache-2.0
// Random numbers that are a function of what they are for (pixel, sample, lamp, dimension) and of
// the seed: no state, no order, the same on every device and for any number of threads.
#ifndef NEARFIELD_RNG_GLSL_H
#define NEARFIELD_RNG_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

// Hash of four words: pcg4d of Jarzynski and Olano, "Hash functions for GPU rendering", JCGT 9(3),
// 2020.
GPU_FN uvec4 hash4(uvec4 key) {
    uvec4 v = key * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v = v ^ (v >> 16u);
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// 24 bits of a word as a float in [0, 1): the largest is 1 - 2^-24.
GPU_FN float unit_float(uint word) {
    return float(word >> 8u) * 5.9604644775390625e-8f;
}

// Point q of the two-dimensional R2 lattice (Roberts, "The unreasonable effectiveness of
// quasirandom sequences", 2018), shifted. In integers, so that large q lose no digits: multipliers
// are 2^32/g and 2^32/g^2, g^3 = g + 1.
GPU_FN vec2 r2_point(uint q, uvec2 shift) {
    return vec2(unit_float(q * 3242174889u + shift.x), unit_float(q * 2447445414u + shift.y));
}

SHARED_END

#endif
