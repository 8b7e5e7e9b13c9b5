// SPDX-License-Identifier: Apache-2.0
// Reflection: Lambert's and normalised Phong's, in 1/sr.
#ifndef NEARFIELD_BRDF_GLSL_H
#define NEARFIELD_BRDF_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

const float kInversePi = 0.318309886f;

// Phong's lobe about the mirror direction, of weight 1: (n + 2)/(2 pi) cos^n(angle to the mirror
// direction). Its albedo is 1 at normal incidence and below 1 elsewhere (Lafortune and Willems,
// "Using the modified Phong reflectance model for physically based rendering", 1994). normal,
// to_light, to_viewer: unit length, on one side of the surface.
GPU_FN float phong_lobe(vec3 normal, vec3 to_light, vec3 to_viewer, float exponent) {
    vec3 mirrored = normal * (2.0f * dot(normal, to_light)) - to_light;
    float cosine = max(dot(mirrored, to_viewer), 0.0f);
    // pow(0, 0) is undefined in GLSL; a lobe of exponent 0 is even over the mirror direction's
    // hemisphere.
    float power = cosine > 0.0f ? pow(cosine, exponent) : 0.0f;
    return (exponent + 2.0f) * 0.5f * kInversePi * power;
}

SHARED_END

#endif
