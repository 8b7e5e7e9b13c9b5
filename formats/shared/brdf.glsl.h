// SPDX-License-Identifier: Apache-2.0
// Reflection f_r in 1/sr: Lambert's plus one glossy lobe, with directions drawn in proportion
// (nearly) and their density, so that light and BRDF sampling combine.
//
// Local frame (frame.glsl.h): z is the shading normal, x the tangent. to_light and to_viewer have
// unit length and point away from the surface. Directions below the surface, or less than 1e-6
// above its horizon, reflect nothing and have density 0, though they may be drawn.
#ifndef NEARFIELD_BRDF_GLSL_H
#define NEARFIELD_BRDF_GLSL_H

#include "formats/shared/brdf_ggx.glsl.h"
#include "formats/shared/brdf_lobes.glsl.h"

SHARED_BEGIN

const uint kBrdfPhong = 0u;
const uint kBrdfGgx = 1u;
const uint kBrdfWard = 2u;
const uint kBrdfLafortune = 3u;
const uint kBrdfHalfwayDisk = 4u;

// Closer to the horizon than this a direction in float says nothing, and lobes overflow.
const float kBrdfHorizon = 1e-6f;

struct Brdf {
    uint kind;
    vec3 diffuse;    // Lambert's albedo, 0 ... 1; brdf_diffuse says what a viewer gets of it
    vec3 specular;   // weight of the lobe; GGX: reflectance F0 at normal incidence; 0: no lobe
    float exponent;  // Phong, Lafortune, halfway disk, >= 0
    vec2 alpha;      // GGX, Ward: roughness along x and y, 1e-3 ... 1
    vec3 cosines;    // Lafortune: C_x, C_y, C_z, -1 ... 1
};

GPU_FN bool brdf_is_glossy(Brdf brdf) {
    return max(brdf.specular.x, max(brdf.specular.y, brdf.specular.z)) > 0.0f;
}

GPU_FN bool brdf_is_above(vec3 direction) {
    return direction.z > kBrdfHorizon;
}

// Fresnel's reflectance by Schlick's formula; cosine: between direction and facet.
GPU_FN vec3 schlick_fresnel(vec3 f0, float cosine) {
    float rest = 1.0f - clamp(cosine, 0.0f, 1.0f);
    float square = rest * rest;
    return mix(f0, vec3(1.0f), square * square * rest);
}

// Albedo of the Lambert part as seen by a viewer: what GGX' Fresnel reflection leaves of it, all of
// it under the other lobes. f_r = brdf_diffuse / pi + brdf_lobe. The factor depends on the viewer
// alone, so that a diffuse part remains an irradiance times a constant; f_r of a GGX with a diffuse
// part is therefore not reciprocal, though its lobe is.
GPU_FN vec3 brdf_diffuse(Brdf brdf, vec3 to_viewer) {
    if (brdf.kind != kBrdfGgx || !brdf_is_glossy(brdf))
        return brdf.diffuse;
    return brdf.diffuse * (vec3(1.0f) - schlick_fresnel(brdf.specular, to_viewer.z));
}

// The glossy lobe with its weight, without the diffuse part.
GPU_FN vec3 brdf_lobe(Brdf brdf, vec3 to_light, vec3 to_viewer) {
    if (!brdf_is_above(to_light) || !brdf_is_above(to_viewer))
        return vec3(0.0f);
    switch (brdf.kind) {
        case kBrdfGgx: {
            float cosine = 0.5f * length(to_light + to_viewer);
            return schlick_fresnel(brdf.specular, cosine) *
                   ggx_lobe(brdf.alpha, to_light, to_viewer);
        }
        case kBrdfWard:
            return brdf.specular * ward_lobe(brdf.alpha, to_light, to_viewer);
        case kBrdfLafortune:
            return brdf.specular * lafortune_lobe(brdf.cosines, brdf.exponent, to_light, to_viewer);
        case kBrdfHalfwayDisk:
            return brdf.specular * halfway_disk_lobe(brdf.exponent, to_light, to_viewer);
        default:
            return brdf.specular *
                   lafortune_lobe(vec3(-1.0f, -1.0f, 1.0f), brdf.exponent, to_light, to_viewer);
    }
}

// A direction to the light drawn by the lobe. It may lie below the surface. xi: uniform in [0,
// 1)^2.
GPU_FN vec3 brdf_lobe_sample(Brdf brdf, vec3 to_viewer, vec2 xi) {
    switch (brdf.kind) {
        case kBrdfGgx:
            return ggx_sample(brdf.alpha, to_viewer, xi);
        case kBrdfWard:
            return ward_sample(brdf.alpha, to_viewer, xi);
        case kBrdfLafortune:
            return cosine_power_sample(lafortune_axis(brdf.cosines, to_viewer), brdf.exponent, xi);
        case kBrdfHalfwayDisk:
            return halfway_disk_sample(brdf.exponent, to_viewer, xi);
        default:
            return cosine_power_sample(vec3(-to_viewer.x, -to_viewer.y, to_viewer.z), brdf.exponent,
                                       xi);
    }
}

// Density of brdf_lobe_sample per solid angle.
GPU_FN float brdf_lobe_density(Brdf brdf, vec3 to_light, vec3 to_viewer) {
    if (!brdf_is_above(to_light) || !brdf_is_above(to_viewer))
        return 0.0f;
    switch (brdf.kind) {
        case kBrdfGgx:
            return ggx_density(brdf.alpha, to_light, to_viewer);
        case kBrdfWard:
            return ward_density(brdf.alpha, to_light, to_viewer);
        case kBrdfLafortune:
            return cosine_power_density(lafortune_axis(brdf.cosines, to_viewer), to_light,
                                        brdf.exponent);
        case kBrdfHalfwayDisk:
            return halfway_disk_density(brdf.exponent, to_light, to_viewer);
        default:
            return cosine_power_density(vec3(-to_viewer.x, -to_viewer.y, to_viewer.z), to_light,
                                        brdf.exponent);
    }
}

// f_r, 1/sr.
GPU_FN vec3 brdf_eval(Brdf brdf, vec3 to_light, vec3 to_viewer) {
    if (!brdf_is_above(to_light) || !brdf_is_above(to_viewer))
        return vec3(0.0f);
    vec3 diffuse = brdf_diffuse(brdf, to_viewer) * kInversePi;
    return brdf_is_glossy(brdf) ? diffuse + brdf_lobe(brdf, to_light, to_viewer) : diffuse;
}

// Share of the lobe among drawn directions: its part of the albedo, roughly.
GPU_FN float brdf_lobe_probability(Brdf brdf, vec3 to_viewer) {
    vec3 weight = brdf.kind == kBrdfGgx && brdf_is_glossy(brdf)
                      ? schlick_fresnel(brdf.specular, to_viewer.z)
                      : brdf.specular;
    float lobe = dot(weight, vec3(1.0f));
    float diffuse = dot(brdf_diffuse(brdf, to_viewer), vec3(1.0f));
    return lobe > 0.0f ? lobe / (lobe + diffuse) : 0.0f;
}

// A direction to the light drawn by the diffuse part's cosine or by the lobe. It may lie below the
// surface. xi: uniform in [0, 1)^3; xi.z chooses.
GPU_FN vec3 brdf_sample(Brdf brdf, vec3 to_viewer, vec3 xi) {
    if (xi.z < brdf_lobe_probability(brdf, to_viewer))
        return brdf_lobe_sample(brdf, to_viewer, vec2(xi.x, xi.y));
    return cosine_power_sample(vec3(0.0f, 0.0f, 1.0f), 1.0f, vec2(xi.x, xi.y));
}

// Density of brdf_sample per solid angle. It integrates over the hemisphere to the probability of
// not going below the surface.
GPU_FN float brdf_density(Brdf brdf, vec3 to_light, vec3 to_viewer) {
    if (!brdf_is_above(to_light) || !brdf_is_above(to_viewer))
        return 0.0f;
    float share = brdf_lobe_probability(brdf, to_viewer);
    float diffuse = (1.0f - share) * to_light.z * kInversePi;
    return share > 0.0f ? diffuse + share * brdf_lobe_density(brdf, to_light, to_viewer) : diffuse;
}

// How far, in radians, the light must move from the lobe's middle, in the direction in which the
// lobe is narrowest, until it has fallen to about exp(-1/2): decides whether a sum over texels
// resolves it. 4 (wider than any) where there is no lobe.
GPU_FN float brdf_lobe_width_rad(Brdf brdf, vec3 to_viewer) {
    if (!brdf_is_glossy(brdf))
        return 4.0f;
    float cosine = max(to_viewer.z, kBrdfHorizon);
    float alpha = min(brdf.alpha.x, brdf.alpha.y);
    // A half vector's turn by x turns the light by 2x in the plane of incidence, by 2x cosine
    // across.
    switch (brdf.kind) {
        case kBrdfGgx:  // (1 + tan^2/alpha^2)^-2 = exp(-1/2) at tan = 0.533 alpha
            return 2.0f * 0.533f * alpha * cosine;
        case kBrdfWard:  // exp(-tan^2/alpha^2)
            return 1.41421356f * alpha * cosine;
        case kBrdfHalfwayDisk:  // (1 - |w|^2)^(n + 1), and v_z^2 from w to projections
            return inversesqrt(2.0f * (brdf.exponent + 1.0f)) * cosine * cosine;
        default:
            return inversesqrt(max(brdf.exponent, 0.1f));
    }
}

SHARED_END

#endif
