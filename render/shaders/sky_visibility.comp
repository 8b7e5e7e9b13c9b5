// SPDX-License-Identifier: Apache-2.0
// Cosine times what of the sky is hidden, fitted by harmonics pixel by pixel: as hidden_sky of
// render/cpu/shade_sky.cpp, by maps in place of rays.
#include "render/shaders/sky.glsl"
#include "render/shaders/sky_maps.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, binding = 7) readonly restrict buffer SkyFit { float sky_fit[]; };  // [16][direction]
layout(rgba32f, binding = 2) uniform writeonly restrict image2DArray hidden_image;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(lamp_light))))
        return;
    Surface surface = surface_at(pixel);
    float sums[kHarmonics];
    for (int k = 0; k < kHarmonics; ++k)
        sums[k] = 0.0;
    int count = surface.material < 0 ? 0 : sky.counts.y;
    for (int n = 0; n < count; ++n) {
        float cosine = dot(surface.normal, world_from_sky(sky_directions[n].direction.xyz));
        if (!(cosine > 0.0))
            continue;
        float hidden = cosine * (1.0 - sky_is_open(n, surface.position_m, surface.normal));
        if (hidden > 0.0)
            for (int k = 0; k < kHarmonics; ++k)
                sums[k] += sky_fit[k * count + n] * hidden;
    }
    for (int layer = 0; layer < kHarmonics / 4; ++layer)
        imageStore(hidden_image, ivec3(pixel, layer),
                   vec4(sums[4 * layer], sums[4 * layer + 1], sums[4 * layer + 2], sums[4 * layer + 3]));
}
