// SPDX-License-Identifier: Apache-2.0
// Means of what neighboring pixels find hidden, over those of the same surface: texels of shadow
// maps, which few directions show as steps, are blurred (Krivanek and Colbert 2008, section 5.2,
// there in texture space).
#include "render/shaders/sky.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 9) uniform sampler2DArray found_hidden;
layout(rgba32f, binding = 2) uniform writeonly restrict image2DArray hidden_image;

layout(location = 0) uniform int radius_px;

// Of a neighbor: it looks the same way, and lies near the pixel's own plane, not behind an edge.
float weight_of(Surface surface, Surface neighbor) {
    if (neighbor.material < 0)
        return 0.0;
    vec3 across = neighbor.position_m - surface.position_m;
    bool is_same = abs(dot(across, surface.normal)) <= 0.2 * length(across) + 1e-9;
    float cosine = max(dot(surface.normal, neighbor.normal), 0.0);
    return is_same ? pow(cosine, 32.0) : 0.0;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(lamp_light);
    if (any(greaterThanEqual(pixel, size)))
        return;
    Surface surface = surface_at(pixel);
    vec4 sums[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    float weights = 0.0;
    int radius = surface.material < 0 ? -1 : radius_px;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
            ivec2 at = pixel + ivec2(x, y);
            if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size)))
                continue;
            float weight = weight_of(surface, surface_at(at));
            weights += weight;
            for (int layer = 0; layer < 4; ++layer)
                sums[layer] += weight * texelFetch(found_hidden, ivec3(at, layer), 0);
        }
    for (int layer = 0; layer < 4; ++layer)
        imageStore(hidden_image, ivec3(pixel, layer), weights > 0.0 ? sums[layer] / weights : vec4(0.0));
}
