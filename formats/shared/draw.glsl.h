// SPDX-License-Identifier: Apache-2.0
// Random numbers of samplers: points of the plane, shifts of pixels and sets, strata.
#ifndef NEARFIELD_DRAW_GLSL_H
#define NEARFIELD_DRAW_GLSL_H

#include "formats/shared/portable.glsl.h"
#include "formats/shared/rng.glsl.h"
#include "formats/shared/sequences.glsl.h"

SHARED_BEGIN

#ifdef __cplusplus
using glm::floatBitsToUint;
#endif

const uint kSequenceHalton = 0u;
const uint kSequenceR2 = 1u;
const uint kSequenceFibonacci = 2u;
const uint kSequenceSobol = 3u;

const uint kShiftConstant = 0u;
const uint kShiftRandom = 1u;
const uint kShiftBlueNoise = 2u;
const uint kShiftInterleaved = 3u;

// Shifts of a glossy lobe's samples take the seed ^ this: they are independent of the lamp's.
const uint kLobeSeed = 0x9e3779b9u;

const float kBelowOne = 0.99999994f;  // 1 - 2^-24

GPU_FN uvec2 shift_words(vec2 shift) {
    return uvec2(unit_word(shift.x), unit_word(shift.y));
}

// Scrambling's seed: all bits of a shift.
GPU_FN uvec2 seed_words(vec2 shift) {
    return uvec2(floatBitsToUint(shift.x), floatBitsToUint(shift.y));
}

GPU_FN vec2 unit_floats(uvec2 words) {
    return vec2(unit_float(words.x), unit_float(words.y));
}

// Point q of `count` in [0, 1)^2, shifted.
GPU_FN vec2 plane_point(uint sequence, uint q, uint count, vec2 shift) {
    if (sequence == kSequenceHalton)
        return unit_floats(halton_point(q) + shift_words(shift));
    if (sequence == kSequenceSobol)
        return unit_floats(sobol_point(q, seed_words(shift)));
    if (sequence == kSequenceFibonacci) {
        float first = float((double(q) + double(shift.x)) / double(count));
        return vec2(min(first, kBelowOne), unit_float(golden_word(q) + shift_words(shift).y));
    }
    return r2_point(q, shift_words(shift));
}

// The second coordinate alone, of a point whose first is (q + shift.x) / count.
GPU_FN float second_coordinate(uint sequence, uint q, vec2 shift) {
    uint moved = shift_words(shift).y;
    if (sequence == kSequenceHalton)
        return unit_float(radical_inverse_3(q + 1u) + moved);
    // Sobol is not shuffled: the first coordinate keeps the order of q. By the second shift alone,
    // which the first must not depend on; hashed, since scrambling needs all of 32 bits.
    if (sequence == kSequenceSobol)
        return unit_float(owen_scramble(sobol_second(q), hash4(uvec4(moved, 0u, 0u, 4u)).x));
    return unit_float(golden_word(q) + moved);
}

// A third number in [0, 1), independent of both of the shift's.
GPU_FN float third_shift(vec2 shift) {
    uvec2 seed = seed_words(shift);
    return unit_float(hash4(uvec4(seed.x, seed.y, 0u, 3u)).x);
}

// Where sample q of `count` falls in a running sum up to `total`.
GPU_FN double stratum_target(uint q, float start, uint count, double total) {
    return (double(q) + double(start)) / double(count) * total;
}

// How many samples Pdis gives an image: eq. (12), rounded, at most k_max (0: no limit).
GPU_FN int pdis_count(int samples, int k_max, double lamp_total, float energy) {
    int rounded = int(floor(double(samples) * double(energy) / lamp_total + double(0.5f)));
    return k_max > 0 ? min(rounded, k_max) : rounded;
}

// The shift of a pixel in a pass. blue_noise: the tile's value there, for kShiftBlueNoise.
GPU_FN vec2 pixel_shift(uint shift, uvec2 pixel, uint pass, uint seed, vec2 blue_noise) {
    if (shift == kShiftRandom) {
        uvec4 bits = hash4(uvec4(pixel.x, pixel.y, pass, seed));
        return vec2(unit_float(bits.x), unit_float(bits.y));
    }
    if (shift == kShiftBlueNoise) {
        uvec4 start = hash4(uvec4(seed, 0u, 0u, 1u));
        vec2 sum = blue_noise + r2_point(pass, uvec2(start.x, start.y));
        return min(fract(sum), vec2(kBelowOne));
    }
    if (shift == kShiftInterleaved) {
        uvec4 start = hash4(uvec4(pass, seed, 0u, 2u));
        return r2_point(pixel.y % 4u * 4u + pixel.x % 4u, uvec2(start.x, start.y));
    }
    return vec2(0.0f);
}

SHARED_END

#endif
