// SPDX-License-Identifier: Apache-2.0
// Diffuse surfaces by spherical harmonics, less what is hidden: as render/cpu/shade_sky.cpp.
#include "render/shaders/sky.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(lamp_light))))
        return;
    Surface surface = surface_at(pixel);
    if (surface.material < 0)
        return;
    vec3 normal = sky_direction(surface.normal);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < kHarmonicsOfIrradiance; ++k)
        sum += sky.harmonics[k].rgb * (cosine_factor(k) * harmonic(k, normal));
    sum = max(sum, vec3(0.0));
    Hidden hidden = hidden_at(pixel);
    for (int k = 0; k < kHarmonics; ++k)
        sum -= sky.harmonics[k].rgb * hidden.value[k];
    sum = max(sum, vec3(0.0));
    for (int n = 0; n < sky.counts.z; ++n) {
        float cosine = dot(normal, sky_suns[n].direction.xyz);
        if (cosine > kBrdfHorizon)
            sum += sky_suns[n].light.rgb *
                   (cosine * visible_share(hidden, sky_suns[n].direction.xyz, cosine));
    }
    vec3 irradiance = sky.intensity_sun.x * sum;
    vec3 to_viewer = local_from_world(frame_of(surface), surface.to_viewer);
    add_light(pixel, irradiance * brdf_diffuse(brdf_of(surface), to_viewer) * kInversePi, irradiance);
}
