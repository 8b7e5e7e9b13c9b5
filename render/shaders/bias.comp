// SPDX-License-Identifier: Apache-2.0
// Adds what bounds the bias of one lamp's sums on coarse images: how far they are from those on
// finer ones (formats/model/mip_sum.h), both by the same visibility.
#include "formats/shared/tonemap.glsl.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f, binding = 0) uniform readonly restrict image2D lamp_light;
layout(rgba32f, binding = 1) uniform readonly restrict image2D finer_light;
layout(r32f, binding = 2) uniform restrict image2D bias_sum;

layout(location = 0) uniform float weight;  // of the difference of luminances

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(bias_sum)))) {
        return;
    }
    float difference = luminance709(imageLoad(finer_light, pixel).rgb) -
                       luminance709(imageLoad(lamp_light, pixel).rgb);
    float before = imageLoad(bias_sum, pixel).r;
    imageStore(bias_sum, pixel, vec4(before + weight * abs(difference), 0.0, 0.0, 0.0));
}
