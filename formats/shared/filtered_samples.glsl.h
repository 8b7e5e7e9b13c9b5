// SPDX-License-Identifier: Apache-2.0
// Filtered importance sampling: few directions drawn by the BRDF, the same ones for every pixel,
// each with the mean of the environment over the solid angle that it stands for, read from a mip
// level (Krivanek and Colbert, "Real-time shading with filtered importance sampling", 2008; Colbert
// and Krivanek, "GPU-based importance sampling", 2007).
#ifndef NEARFIELD_FILTERED_SAMPLES_GLSL_H
#define NEARFIELD_FILTERED_SAMPLES_GLSL_H

#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/sequences.glsl.h"

SHARED_BEGIN

const uint kLevelFis = 0u;
const uint kLevelGems = 1u;
const uint kLevelNone = 2u;
const uint kLevelMfis = 3u;  // texels_of_sample by mean_density.glsl.h

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
        return 0.5f * log2(max(texels_of_sample, 1.0f)) + 1.0f;
    if (kind == kLevelFis)
        return 0.5f * log2(max(kFisOverlap * texels_of_sample, 1.0f));
    if (kind == kLevelMfis)
        return 0.5f * log2(max(texels_of_sample, 1.0f));
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

// Several lookups of one sample along the longer axis of what it stands for, as wide as the
// shorter: what graphics cards do. On a map: `along` is half the longer axis.
struct MapLookups {
    vec2 along;
    int taps;
    float level;
};

// Half the side of a sample's share of [0, 1)^2 away from xi, along one axis (0: x), towards the
// middle, so that no point leaves it.
GPU_FN vec2 beside_point(vec2 xi, int axis, float count) {
    float half_side = 0.5f * inversesqrt(count);
    if (axis == 0)
        return vec2(xi.x > 0.5f ? xi.x - half_side : xi.x + half_side, xi.y);
    return vec2(xi.x, xi.y > 0.5f ? xi.y - half_side : xi.y + half_side);
}

// Where a direction stands on the map that shows another one, beyond its seam too, less where that
// one stands.
GPU_FN vec2 map_offset(ParaboloidPoint from, vec3 direction) {
    float z = from.side == 0 ? direction.z : -direction.z;
    float scale = 0.5f / (kParaboloidScale * max(1.0f + z, 0.1f));
    return vec2(0.5f + direction.x * scale, 0.5f + direction.y * scale) - from.at;
}

// a, b: half axes of what a sample stands for; texels: of a map's side.
GPU_FN MapLookups lookups_along(vec2 a, vec2 b, float texels) {
    const float most = 16.0f;
    bool is_a_longer = length(a) >= length(b);
    MapLookups lookups;
    lookups.along = is_a_longer ? a : b;
    float longer = length(lookups.along);
    float shorter = max(is_a_longer ? length(b) : length(a), longer / most);
    lookups.taps = longer > 0.0f ? int(ceil(longer / shorter)) : 1;
    lookups.level = log2(max(2.0f * shorter * texels, 1.0f));
    return lookups;
}

// Position of lookup k on the map.
GPU_FN vec2 lookup_at(vec2 middle, MapLookups lookups, int k) {
    float along = (2.0f * float(k) + 1.0f) / float(lookups.taps) - 1.0f;
    return clamp(middle + lookups.along * along, vec2(0.0f), vec2(1.0f));
}

SHARED_END

#endif
