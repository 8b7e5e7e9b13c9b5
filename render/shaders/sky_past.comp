// SPDX-License-Identifier: Apache-2.0
// The environment where nothing is before it: the picture's own pixel.
#include "render/shaders/sky.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 4) uniform sampler2D sky_picture;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(lamp_light))))
        return;
    Surface surface = surface_at(pixel);
    if (surface.material >= 0)
        return;
    // Where nothing is seen the normal is the ray's direction.
    ivec2 size = textureSize(sky_picture, 0);
    vec2 at = latlong_from_direction(sky_direction(surface.normal)) * vec2(size);
    vec3 light = texelFetch(sky_picture, clamp(ivec2(at), ivec2(0), size - 1), 0).rgb;
    add_light(pixel, sky.intensity_sun.x * light, vec3(0.0));
}
