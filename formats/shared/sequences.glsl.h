// SPDX-License-Identifier: Apache-2.0
// Points of low discrepancy in [0, 1)^2, in integers, so that no number of points loses digits.
#ifndef NEARFIELD_SEQUENCES_GLSL_H
#define NEARFIELD_SEQUENCES_GLSL_H

#include "formats/shared/portable.glsl.h"
#include "formats/shared/rng.glsl.h"

SHARED_BEGIN

// 2^32 times x in [0, 1), for sums that wrap around: a Cranley-Patterson rotation is +.
GPU_FN uint unit_word(float x) {
    return uint(x * 16777216.0f) << 8u;
}

GPU_FN uint reverse_bits(uint x) {
    x = (x << 16u) | (x >> 16u);
    x = ((x & 0x00ff00ffu) << 8u) | ((x & 0xff00ff00u) >> 8u);
    x = ((x & 0x0f0f0f0fu) << 4u) | ((x & 0xf0f0f0f0u) >> 4u);
    x = ((x & 0x33333333u) << 2u) | ((x & 0xccccccccu) >> 2u);
    return ((x & 0x55555555u) << 1u) | ((x & 0xaaaaaaaau) >> 1u);
}

// q's radical inverse in base 3, times 2^32, for q < 3^20 (3.4e9).
GPU_FN uint radical_inverse_3(uint q) {
    // 20 digits, reversed, are an integer below 3^20.
    uint reversed = 0u;
    for (int digit = 0; digit < 20; ++digit) {
        reversed = reversed * 3u + q % 3u;
        q = q / 3u;
    }
    return unit_word(min(float(reversed) * 2.867971990792441e-10f, 0.99999994f));
}

// Points 1, 2, 3 and so on of Halton's sequence in bases 2 and 3 (q from 0), times 2^32.
GPU_FN uvec2 halton_point(uint q) {
    return uvec2(reverse_bits(q + 1u), radical_inverse_3(q + 1u));
}

// Sobol's second dimension (the first is reverse_bits), times 2^32: direction numbers of the
// polynomial x + 1, v_k = v_{k-1} ^ (v_{k-1} >> 1).
GPU_FN uint sobol_second(uint q) {
    uint direction = 0x80000000u;
    uint x = 0u;
    for (int bit = 0; bit < 32; ++bit) {
        x = ((q >> uint(bit)) & 1u) == 1u ? x ^ direction : x;
        direction = direction ^ (direction >> 1u);
    }
    return x;
}

// Owen's nested uniform scrambling by hashing (Burley, "Practical hash-based Owen scrambling", JCGT
// 9(4), 2020, with the constants of his listing).
GPU_FN uint owen_scramble(uint x, uint seed) {
    x = reverse_bits(x);
    x += seed;
    x = x ^ (x * 0x6c50b47cu);
    x = x ^ (x * 0xb82f1e52u);
    x = x ^ (x * 0xc7afe638u);
    x = x ^ (x * 0x8d22f6e6u);
    return reverse_bits(x);
}

// Point q of the shuffled and scrambled Sobol sequence, times 2^32. Shuffling keeps every aligned
// block of 2^k indices together, so that it is a net still.
GPU_FN uvec2 sobol_point(uint q, uvec2 seed) {
    uvec4 key = hash4(uvec4(seed.x, seed.y, 1u, 2u));
    uint shuffled = owen_scramble(q, key.x);
    return uvec2(owen_scramble(reverse_bits(shuffled), key.y),
                 owen_scramble(sobol_second(shuffled), key.z));
}

// q times 2^32 over the golden ratio: the lattice of Fibonacci's points, as good for every count.
GPU_FN uint golden_word(uint q) {
    return q * 2654435769u;
}

SHARED_END

#endif
