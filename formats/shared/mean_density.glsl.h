// SPDX-License-Identifier: Apache-2.0
// What a sample stands for where the density changes within it: the cap about its direction that
// holds 1/N of all samples, by the density's mean over the cap and not its value in the middle
// (Tokuyoshi, "Modified filtered importance sampling for virtual spherical Gaussian lights", 2016;
// there on an image's mips, here on the lobe itself). Beside a lobe's peak it is smaller.
#ifndef NEARFIELD_MEAN_DENSITY_GLSL_H
#define NEARFIELD_MEAN_DENSITY_GLSL_H

#include "formats/shared/brdf.glsl.h"
#include "formats/shared/frame.glsl.h"

SHARED_BEGIN

const float kSphere_sr = 12.5663706f;

// Of brdf_lobe_density over a cap of solid_angle_sr about to_light: by eight points of equal solid
// angle.
GPU_FN float mean_lobe_density(Brdf brdf, vec3 to_light, vec3 to_viewer, float solid_angle_sr) {
    SurfaceFrame around = frame_from_normal(to_light);
    float sum = 0.0f;
    for (int k = 0; k < 8; ++k) {
        float ring = k < 4 ? 0.25f : 0.75f;
        float height = ring * 2.0f * solid_angle_sr / kSphere_sr;  // 1 - cosine
        float across = sqrt(max(height * (2.0f - height), 0.0f));
        float azimuth = (float(k) + ring) * 1.57079633f;
        vec3 local = vec3(across * cos(azimuth), across * sin(azimuth), 1.0f - height);
        sum += brdf_lobe_density(brdf, world_from_local(around, local), to_viewer);
    }
    return 0.125f * sum;
}

// The cap that holds 1/count of the lobe's density, by 12 bisections of its logarithm, between 1e-7
// sr and the sphere.
GPU_FN float mfis_solid_angle_sr(Brdf brdf, vec3 to_light, vec3 to_viewer, float count) {
    float low = log2(1e-7f), high = log2(kSphere_sr);
    for (int step = 0; step < 12; ++step) {
        float middle = 0.5f * (low + high);
        float solid_angle_sr = exp2(middle);
        bool is_more =
            solid_angle_sr * mean_lobe_density(brdf, to_light, to_viewer, solid_angle_sr) * count >
            1.0f;
        low = is_more ? low : middle;
        high = is_more ? middle : high;
    }
    return exp2(0.5f * (low + high));
}

SHARED_END

#endif
