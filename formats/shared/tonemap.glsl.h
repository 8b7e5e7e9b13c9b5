// SPDX-License-Identifier: Apache-2.0
// From scene radiance to display values (docs/scenes.md, "Tone mapping").
#ifndef NEARFIELD_TONEMAP_GLSL_H
#define NEARFIELD_TONEMAP_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

// Rec.709 luminance of linear RGB.
GPU_FN float luminance709(vec3 rgb) {
    return dot(rgb, vec3(0.2126f, 0.7152f, 0.0722f));
}

// IEC 61966-2-1, of one channel in [0, 1].
GPU_FN float srgb_from_linear(float x) {
    return x <= 0.0031308f ? 12.92f * x : 1.055f * pow(x, 1.0f / 2.4f) - 0.055f;
}

// The papers' operator, channel by channel: 1 - exp(-L / mean).
GPU_FN vec3 tonemap_papers(vec3 rgb, float mean) {
    return 1.0f - exp(-rgb / mean);
}

// The filmic curve on luminance: toe, straight part, shoulder. Narkowicz, "ACES filmic tone mapping
// curve", 2015; middle gray 0.18 becomes 0.27, and 1 is reached at 7.2.
GPU_FN float filmic_curve(float luminance) {
    float y = min(luminance, 10.0f);  // squares of large values overflow
    return clamp(y * (2.51f * y + 0.03f) / (y * (2.43f * y + 0.59f) + 0.14f), 0.0f, 1.0f);
}

// The curve applied to luminance; the color keeps its ratios, and is mixed with gray of its
// luminance as far as it needs to fit the display.
GPU_FN vec3 tonemap_filmic(vec3 rgb) {
    float before = luminance709(rgb);
    if (!(before > 0.0f)) {
        return vec3(0.0f);
    }
    float after = filmic_curve(before);
    vec3 scaled = max(rgb * (after / before), vec3(0.0f));
    float largest = max(scaled.x, max(scaled.y, scaled.z));
    if (largest <= 1.0f) {
        return scaled;
    }
    // after + t (largest - after) = 1
    float t = clamp((1.0f - after) / (largest - after), 0.0f, 1.0f);
    return clamp(vec3(after) + (scaled - vec3(after)) * t, vec3(0.0f), vec3(1.0f));
}

SHARED_END

#endif
