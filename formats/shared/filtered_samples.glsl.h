// SPDX-License-Identifier: Apache-2.0
// Filtered importance sampling: few directions drawn by the BRDF, the same ones for every pixel,
// each with the mean of the environment over the solid angle that it stands for, read from a mip
// level (Krivanek and Colbert, "Real-time shading with filtered importance sampling", 2008; Colbert
// and Krivanek, "GPU-based importance sampling", 2007).
#ifndef NEARFIELD_FILTERED_SAMPLES_GLSL_H
#define NEARFIELD_FILTERED_SAMPLES_GLSL_H

#include "formats/shared/sequences.glsl.h"

SHARED_BEGIN

const uint kLevelFis = 0u;
const uint kLevelGems = 1u;
const uint kLevelNone = 2u;

// Area of the filter in samples' shares of [0, 1)^2: found empirically by Krivanek and Colbert for
// mips made by a box filter.
const float kFisOverlap = 4.0f;

// Point i of Hammersley's set of `count` in [0, 1)^2, in the middle of its stratum in x.
GPU_FN vec2 hammersley_point(uint i, uint count) {
    return vec2((float(i) + 0.5f) / float(count), unit_float(reverse_bits(i)));
}

// How many texels of a map one of `count` samples stands for: 1/(count density) of solid angle over
// a texel's. texels: of one whole map; density: per solid angle, > 0.
GPU_FN float texels_per_sample(float texels, float count, float density, float sr_per_area) {
    return texels / (count * density * sr_per_area);
}

// The mip level whose texels hold that many, blurred as the kind says: 4^level = 4 x texels (FIS),
// or one level more than 4^level = texels (Gems); they differ where a sample stands for less than a
// texel.
GPU_FN float filter_level(uint kind, float texels_of_sample) {
    if (kind == kLevelGems)
        return max(0.5f * log2(texels_of_sample), 0.0f) + 1.0f;
    if (kind == kLevelFis)
        return max(0.5f * log2(kFisOverlap * texels_of_sample), 0.0f);
    return 0.0f;
}

// Four texels of one level of a square map of side `side` and their weights, for a position in [0,
// 1]^2: linear interpolation between texels' centers, the border's texels continued.
struct LinearTaps {
    ivec2 low, high;  // column and row
    vec2 part;        // of high, in x and y
};

GPU_FN LinearTaps linear_taps(vec2 at, int side) {
    vec2 texel = clamp(at * float(side) - vec2(0.5f), vec2(0.0f), vec2(float(side - 1)));
    LinearTaps taps;
    taps.low = ivec2(int(texel.x), int(texel.y));
    taps.high = ivec2(min(taps.low.x + 1, side - 1), min(taps.low.y + 1, side - 1));
    taps.part = texel - vec2(float(taps.low.x), float(taps.low.y));
    return taps;
}

SHARED_END

#endif
