// SPDX-License-Identifier: Apache-2.0
// GGX, anisotropic: a lobe of microfacets without Fresnel's factor. Conventions as in
// brdf_lobes.glsl.h; alpha: roughness along x and y.
#ifndef NEARFIELD_BRDF_GGX_GLSL_H
#define NEARFIELD_BRDF_GGX_GLSL_H

#include "formats/shared/brdf_lobes.glsl.h"

SHARED_BEGIN

// Density of facets' normals. Walter, Marschner, Li, Torrance, "Microfacet models for refraction
// through rough surfaces", 2007, eq. (33), anisotropic.
GPU_FN float ggx_normals(vec2 alpha, vec3 h) {
    float x = h.x / alpha.x;
    float y = h.y / alpha.y;
    float q = x * x + y * y + h.z * h.z;
    return 1.0f / (kPi * alpha.x * alpha.y * q * q);
}

// z (1 + 2 Lambda) of Smith's masking function for a direction.
GPU_FN float ggx_masking_root(vec2 alpha, vec3 direction) {
    float x = alpha.x * direction.x;
    float y = alpha.y * direction.y;
    return sqrt(direction.z * direction.z + x * x + y * y);
}

// D G/(4 l_z v_z) with Smith's height-correlated masking and shadowing: G/(4 l_z v_z) =
// 1/(2 (l_z root_v + v_z root_l)). Heitz, "Understanding the masking-shadowing function in
// microfacet-based BRDFs", JCGT 3(2), 2014, eq. (99).
GPU_FN float ggx_lobe(vec2 alpha, vec3 to_light, vec3 to_viewer) {
    vec3 h = normalize(to_light + to_viewer);
    float masking = to_light.z * ggx_masking_root(alpha, to_viewer) +
                    to_viewer.z * ggx_masking_root(alpha, to_light);
    return 0.5f * ggx_normals(alpha, h) / masking;
}

// Mirrors the viewer at facets drawn as it sees them. Heitz, "Sampling the GGX distribution of
// visible normals", JCGT 7(4), 2018, listing 1.
GPU_FN vec3 ggx_sample(vec2 alpha, vec3 to_viewer, vec2 xi) {
    vec3 stretched = normalize(vec3(alpha.x * to_viewer.x, alpha.y * to_viewer.y, to_viewer.z));
    float square = stretched.x * stretched.x + stretched.y * stretched.y;
    vec3 across = vec3(1.0f, 0.0f, 0.0f);
    if (square > 0.0f)
        across = vec3(-stretched.y, stretched.x, 0.0f) * inversesqrt(square);
    vec3 up = cross(stretched, across);

    float radius = sqrt(xi.x);
    float angle = 2.0f * kPi * xi.y;
    float t1 = radius * cos(angle);
    float half_chord = sqrt(max(1.0f - t1 * t1, 0.0f));
    float t2 = mix(half_chord, radius * sin(angle), 0.5f * (1.0f + stretched.z));
    float t3 = sqrt(max(1.0f - t1 * t1 - t2 * t2, 0.0f));

    vec3 facet = across * t1 + up * t2 + stretched * t3;
    vec3 h = normalize(vec3(alpha.x * facet.x, alpha.y * facet.y, max(facet.z, 0.0f)));
    return h * (2.0f * dot(h, to_viewer)) - to_viewer;
}

// G1 D/(4 v_z): visible normals, and mirroring's 1/(4 v.h).
GPU_FN float ggx_density(vec2 alpha, vec3 to_light, vec3 to_viewer) {
    vec3 h = normalize(to_light + to_viewer);
    return 0.5f * ggx_normals(alpha, h) / (to_viewer.z + ggx_masking_root(alpha, to_viewer));
}

SHARED_END

#endif
