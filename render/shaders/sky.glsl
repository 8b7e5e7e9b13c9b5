// SPDX-License-Identifier: Apache-2.0
// The scene's environment and the surface that it lights. Bound by render/gpu/sky_textures.cpp.
#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/spherical_harmonics.glsl.h"
#include "render/shaders/surface.glsl"

layout(std140, binding = 2) uniform SkyBlock {
    mat4 environment_from_world;
    vec4 harmonics[kHarmonics];  // radiance, r g b
    vec4 intensity_sun;          // intensity; the largest sun's radius, radians; relative error
    ivec4 counts;                // filtered samples; directions; suns; camera samples
} sky;

// Of directions that hold most of the light: in the environment's frame; radiance over (count
// density), r g b.
struct SkyDirection {
    vec4 direction, light;
};
layout(std430, binding = 5) readonly restrict buffer SkyDirections { SkyDirection sky_directions[]; };
// Suns that are summed apart; light: irradiance on a surface that faces them.
layout(std430, binding = 4) readonly restrict buffer SkySuns { SkyDirection sky_suns[]; };

#ifdef HAS_SHADOWS
// What of the sky is hidden times the cosine: 16 coefficients, four a layer.
layout(binding = 7) uniform sampler2DArray sky_hidden;
#endif

layout(rgba32f, binding = 0) uniform restrict image2D lamp_light;
layout(rgba32f, binding = 1) uniform restrict image2D lamp_irradiance;

vec3 sky_direction(vec3 world) { return mat3(sky.environment_from_world) * world; }
vec3 world_from_sky(vec3 direction) { return direction * mat3(sky.environment_from_world); }

struct Hidden {
    float value[kHarmonics];
};

Hidden hidden_at(ivec2 pixel) {
    Hidden hidden;
    for (int layer = 0; layer < kHarmonics / 4; ++layer) {
#ifdef HAS_SHADOWS
        vec4 four = texelFetch(sky_hidden, ivec3(pixel, layer), 0);
#else
        vec4 four = vec4(0.0);
#endif
        for (int k = 0; k < 4; ++k)
            hidden.value[4 * layer + k] = four[k];
    }
    return hidden;
}

float visible_share(Hidden hidden, vec3 direction, float cosine) {
#ifdef HAS_SHADOWS
    float value = 0.0;
    for (int k = 0; k < kHarmonics; ++k)
        value += hidden.value[k] * harmonic(k, direction);
    return 1.0 - clamp(value / max(cosine, kLeastHiddenCosine), 0.0, 1.0);
#else
    return 1.0;
#endif
}

void add_light(ivec2 pixel, vec3 radiance, vec3 irradiance) {
    imageStore(lamp_light, pixel, imageLoad(lamp_light, pixel) + vec4(radiance, 0.0));
    imageStore(lamp_irradiance, pixel, imageLoad(lamp_irradiance, pixel) + vec4(irradiance, 0.0));
}
