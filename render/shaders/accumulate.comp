// SPDX-License-Identifier: Apache-2.0
// Adds one lamp's light of one pass to the picture's sums: light times the pass' weight, its variance
// times the weight's square.
layout(local_size_x = 8, local_size_y = 8) in;

layout(rgba32f, binding = 0) uniform readonly restrict image2D lamp_light;
layout(rgba32f, binding = 1) uniform readonly restrict image2D lamp_irradiance;
layout(rgba32f, binding = 2) uniform restrict image2D radiance_sum;  // a: variance of Y
layout(rgba32f, binding = 3) uniform restrict image2D irradiance_sum;
layout(rgba32f, binding = 4) uniform restrict image2D of_lamp_sum;   // radiance, this lamp's alone

layout(location = 0) uniform float weight;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(radiance_sum)))) {
        return;
    }
    vec4 light = imageLoad(lamp_light, pixel);
    vec4 weighted = vec4(weight * light.rgb, weight * weight * light.a);
    imageStore(radiance_sum, pixel, imageLoad(radiance_sum, pixel) + weighted);
    imageStore(of_lamp_sum, pixel, imageLoad(of_lamp_sum, pixel) + weighted);
    vec4 irradiance = vec4(weight * imageLoad(lamp_irradiance, pixel).rgb, 0.0);
    imageStore(irradiance_sum, pixel, imageLoad(irradiance_sum, pixel) + irradiance);
}
