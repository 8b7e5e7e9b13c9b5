// SPDX-License-Identifier: Apache-2.0
// What a direction drawn by a lobe carries: lobe * cosine / density, with what both share left out,
// so that narrow lobes lose no digits and cost no second exponential.
#ifndef NEARFIELD_BRDF_WEIGHT_GLSL_H
#define NEARFIELD_BRDF_WEIGHT_GLSL_H

#include "formats/shared/brdf.glsl.h"

SHARED_BEGIN

// (n + 2)/(n + 1) |C v|^n l_z
GPU_FN float lafortune_weight(vec3 cosines, float exponent, vec3 to_light, vec3 to_viewer) {
    float size = length(cosines * to_viewer);
    if (!(size > 0.0f))
        return 0.0f;
    return (exponent + 2.0f) / (exponent + 1.0f) * pow(size, exponent) * to_light.z;
}

// G/G1 of the viewer.
GPU_FN float ggx_weight(vec2 alpha, vec3 to_light, vec3 to_viewer) {
    float root_of_viewer = ggx_masking_root(alpha, to_viewer);
    return to_light.z * (to_viewer.z + root_of_viewer) /
           (to_light.z * root_of_viewer + to_viewer.z * ggx_masking_root(alpha, to_light));
}

// brdf_lobe * to_light.z / brdf_lobe_density.
GPU_FN vec3 brdf_lobe_weight(Brdf brdf, vec3 to_light, vec3 to_viewer) {
    if (!brdf_is_above(to_light) || !brdf_is_above(to_viewer))
        return vec3(0.0f);
    switch (brdf.kind) {
        case kBrdfGgx: {
            float cosine = 0.5f * length(to_light + to_viewer);
            return schlick_fresnel(brdf.specular, cosine) *
                   ggx_weight(brdf.alpha, to_light, to_viewer);
        }
        case kBrdfWard:
            return brdf.specular * (2.0f * to_light.z / (to_light.z + to_viewer.z));
        case kBrdfLafortune:
            return brdf.specular *
                   lafortune_weight(brdf.cosines, brdf.exponent, to_light, to_viewer);
        case kBrdfHalfwayDisk: {
            float ratio = to_light.z / to_viewer.z;
            return brdf.specular * (ratio * ratio);
        }
        default:
            return brdf.specular * ((brdf.exponent + 2.0f) / (brdf.exponent + 1.0f) * to_light.z);
    }
}

SHARED_END

#endif
