// SPDX-License-Identifier: Apache-2.0
// Philox4x32-10: a counter-based generator that passes BigCrush, for reference runs. Slower than
// rng.glsl.h's hash. Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3",
// 2011.
#ifndef NEARFIELD_PHILOX_GLSL_H
#define NEARFIELD_PHILOX_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

// The upper 32 bits of a product, by halves of 16: a sum of partial products never overflows.
GPU_FN uint product_high(uint a, uint b) {
    uint a_lo = a & 0xffffu, a_hi = a >> 16u;
    uint b_lo = b & 0xffffu, b_hi = b >> 16u;
    uint low_carry = (a_lo * b_lo) >> 16u;
    uint middle = a_hi * b_lo + low_carry;
    uint other = a_lo * b_hi + (middle & 0xffffu);
    return a_hi * b_hi + (middle >> 16u) + (other >> 16u);
}

// Four words that are a function of counter and key: different counters, independent numbers.
GPU_FN uvec4 philox4x32(uvec4 counter, uvec2 key) {
    uvec4 c = counter;
    uvec2 k = key;
    for (int round = 0; round < 10; ++round) {
        uint hi0 = product_high(0xd2511f53u, c.x);
        uint hi1 = product_high(0xcd9e8d57u, c.z);
        c = uvec4(hi1 ^ c.y ^ k.x, 0xcd9e8d57u * c.z, hi0 ^ c.w ^ k.y, 0xd2511f53u * c.x);
        k = uvec2(k.x + 0x9e3779b9u, k.y + 0xbb67ae85u);
    }
    return c;
}

SHARED_END

#endif
