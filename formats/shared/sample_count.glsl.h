// SPDX-License-Identifier: Apache-2.0
// How many filtered samples reach an error, by what is known before any is drawn: how far the
// environment varies within the lobe (its roughness says where that is), and, by curvature, whether
// the camera samples of a pixel look at different parts of it.
//
// One filtered sample would give the environment's mean over the lobe, whose error is how far light
// varies there: the relative deviation s. N samples leave about s/N^0.8 of it, which is what the
// errors of spheres under measured light fall by (docs/environments.md). Camera samples that look
// at different parts of the environment err independently.
#ifndef NEARFIELD_SAMPLE_COUNT_GLSL_H
#define NEARFIELD_SAMPLE_COUNT_GLSL_H

#include "formats/shared/brdf.glsl.h"

SHARED_BEGIN

const float kSampleCountRate = 0.8f;
const float kSampleCountStep = 8.0f;  // counts are multiples: what neighbors draw is mostly alike

// The lobe's middle: the mirrored viewer, but Lafortune's own axis.
GPU_FN vec3 brdf_lobe_axis(Brdf brdf, vec3 to_viewer) {
    return brdf.kind == kBrdfLafortune ? lafortune_axis(brdf.cosines, to_viewer)
                                       : vec3(-to_viewer.x, -to_viewer.y, to_viewer.z);
}

// Solid angle that a lobe covers, 1/(integral of its density squared): twice that over its peak's
// density, for a Gaussian. 0: it lies below the horizon.
GPU_FN float brdf_lobe_solid_angle_sr(Brdf brdf, vec3 to_viewer) {
    float peak = brdf_lobe_density(brdf, brdf_lobe_axis(brdf, to_viewer), to_viewer);
    return peak > 0.0f ? 2.0f / peak : 0.0f;
}

// Of light's mean and the mean of its square.
GPU_FN float relative_variance(float mean, float mean_square) {
    return mean > 0.0f ? max(mean_square / (mean * mean) - 1.0f, 0.0f) : 0.0f;
}

// Of a triangle, in 1/m: how far its corners' normals turn by length, along the edge where that is
// most. Normals of unit length.
GPU_FN float triangle_curvature(
    vec3 edge_ab_m, vec3 edge_bc_m, vec3 normal_a, vec3 normal_b, vec3 normal_c) {
    const float least = 1e-30f;  // an edge of no length says nothing
    float ab = distance(normal_a, normal_b) / max(length(edge_ab_m), least);
    float bc = distance(normal_b, normal_c) / max(length(edge_bc_m), least);
    float ca = distance(normal_c, normal_a) / max(length(edge_ab_m + edge_bc_m), least);
    return max(ab, max(bc, ca));
}

// How many of a pixel's camera samples see parts of the environment that have nothing to do with
// each other. turn_rad: of the normal across the pixel; a mirrored direction turns twice as far.
GPU_FN float independent_looks(float turn_rad, float lobe_sr, float camera_samples) {
    float radius_rad = sqrt(lobe_sr / 12.5663706f);  // of a Gaussian of that solid angle
    float along = 1.0f + 2.0f * turn_rad / max(radius_rad, 1e-6f);
    return min(along * along, camera_samples);
}

// error: relative, > 0; most: at most so many.
GPU_FN int filtered_sample_count(float variance, float looks, float error, int most) {
    float deviation = sqrt(variance / looks);
    float wanted = pow(max(deviation / error, 1e-6f), 1.0f / kSampleCountRate);
    float steps = ceil(min(wanted, float(most)) / kSampleCountStep);
    return min(int(max(steps, 1.0f) * kSampleCountStep), most);
}

SHARED_END

#endif
