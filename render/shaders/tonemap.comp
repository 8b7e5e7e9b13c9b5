// SPDX-License-Identifier: Apache-2.0
// From sums of radiance to what a display shows: 8-bit sRGB.
#include "formats/shared/tonemap.glsl.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f, binding = 0) uniform readonly restrict image2D radiance_sum;
layout(rgba8, binding = 1) uniform writeonly restrict image2D srgb;

layout(location = 0) uniform float scale;  // 1 over the sum of the passes' weights
layout(location = 1) uniform float white;  // radiance that becomes 1 before the curve
layout(location = 2) uniform int is_papers;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(srgb)))) {
        return;
    }
    vec3 radiance = scale * imageLoad(radiance_sum, pixel).rgb;
    vec3 mapped = is_papers == 1 ? tonemap_papers(radiance, white) : tonemap_filmic(radiance / white);
    mapped = clamp(mapped, vec3(0.0), vec3(1.0));
    vec3 encoded = vec3(srgb_from_linear(mapped.r), srgb_from_linear(mapped.g), srgb_from_linear(mapped.b));
    imageStore(srgb, pixel, vec4(encoded, 1.0));
}
