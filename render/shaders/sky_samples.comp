// SPDX-License-Identifier: Apache-2.0
// What lobes reflect of the environment, by filtered samples: as filtered_gloss of
// render/cpu/shade_sky.cpp. LEVEL: filtered_samples.glsl.h; IS_ANISOTROPIC; HAS_SHIFT: a texture
// shifts each pixel's samples; HAS_SHADOWS; HAS_COUNTS: as many samples as an error calls for, with
// HAS_TURNS by how far normals turn across a pixel too.
#include "formats/shared/brdf_weight.glsl.h"
#include "formats/shared/filtered_samples.glsl.h"
#include "formats/shared/mean_density.glsl.h"
#include "formats/shared/sample_count.glsl.h"
#include "formats/shared/suns.glsl.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/shaders/sky.glsl"

#ifndef LEVEL
#define LEVEL kLevelFis
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 5) uniform sampler2DArray sky_maps;
layout(binding = 8) uniform sampler2DArray sky_maps_with_suns;  // only beside suns
#ifdef HAS_TURNS
layout(binding = 15) uniform sampler2D surface_turn;  // radians
#endif
#ifdef HAS_SHIFT
layout(binding = 6) uniform sampler2D sky_shift;
#endif

int map_side() { return textureSize(sky_maps, 0).x; }

// r g b and the mean of luminance squared. share: of suns, in maps.
vec4 texel(ivec3 at, int level, float share) {
    vec4 value = share < 1.0 ? (1.0 - share) * texelFetch(sky_maps, at, level) : vec4(0.0);
    return share > 0.0 ? value + share * texelFetch(sky_maps_with_suns, at, level) : value;
}

vec4 on_level(ParaboloidPoint point, int level, float share) {
    // llvmpipe asks for the size of one level for all pixels that it shades together.
    LinearTaps taps = linear_taps(point.at, map_side() >> level);
    ivec3 low = ivec3(taps.low, point.side), high = ivec3(taps.high, point.side);
    return mix(mix(texel(low, level, share), texel(ivec3(high.x, low.y, low.z), level, share), taps.part.x),
               mix(texel(ivec3(low.x, high.y, low.z), level, share), texel(high, level, share), taps.part.x),
               taps.part.y);
}

vec4 filtered(vec3 direction, float level, float share) {
    ParaboloidPoint point = paraboloid_from_direction(direction);
    float clamped = clamp(level, 0.0, float(textureQueryLevels(sky_maps) - 1));
    int finer = int(clamped);
    float part = clamped - float(finer);
    vec4 value = on_level(point, finer, share);
    return part > 0.0 ? mix(value, on_level(point, finer + 1, share), part) : value;
}

struct Lobe {
    Brdf brdf;
    SurfaceFrame frame;
    vec3 to_viewer;  // local
    float share;     // of suns, in maps
};

vec3 in_environment(Lobe lobe, vec3 local) {
    return sky_direction(world_from_local(lobe.frame, local));
}

vec3 filtered_light(Lobe lobe, float count, vec2 xi, vec3 to_light, vec3 direction, float density) {
#ifdef IS_ANISOTROPIC
    ParaboloidPoint middle = paraboloid_from_direction(direction);
    vec2 half_axis[2];
    for (int axis = 0; axis < 2; ++axis)
        half_axis[axis] = map_offset(
            middle, in_environment(lobe, brdf_lobe_sample(lobe.brdf, lobe.to_viewer,
                                                          beside_point(xi, axis, count))));
    MapLookups lookups = lookups_along(half_axis[0], half_axis[1], float(map_side()));
    vec3 sum = vec3(0.0);
    for (int k = 0; k < lookups.taps; ++k)
        sum += filtered(direction_from_paraboloid(middle.side, lookup_at(middle.at, lookups, k)),
                        lookups.level, lobe.share).rgb;
    return sum / float(lookups.taps);
#else
    // The density whose mean a sample stands for.
    float around = LEVEL == kLevelMfis ? 1.0 / (count * mfis_solid_angle_sr(lobe.brdf, to_light,
                                                                            lobe.to_viewer, count))
                                       : density;
    float texels = texels_per_sample(float(map_side() * map_side()), count, around,
                                     paraboloid_sr_per_area(direction));
    return filtered(direction, filter_level(LEVEL, texels), lobe.share).rgb;
#endif
}

// As many samples as the error calls for.
int count_of(Lobe lobe, ivec2 pixel) {
#ifdef HAS_COUNTS
    float lobe_sr = brdf_lobe_solid_angle_sr(lobe.brdf, lobe.to_viewer);
    if (!(lobe_sr > 0.0))
        return sky.counts.x;
    vec3 direction = in_environment(lobe, brdf_lobe_axis(lobe.brdf, lobe.to_viewer));
    float texels = texels_per_sample(float(map_side() * map_side()), 1.0, 1.0 / lobe_sr,
                                     paraboloid_sr_per_area(direction));
    vec4 around = filtered(direction, filter_level(kLevelMfis, texels), lobe.share);
#ifdef HAS_TURNS
    float looks = independent_looks(texelFetch(surface_turn, pixel, 0).r, lobe_sr, float(sky.counts.w));
#else
    float looks = 1.0;
#endif
    return filtered_sample_count(relative_variance(luminance709(around.rgb), around.w), looks,
                                 sky.intensity_sun.z, sky.counts.x);
#else
    return sky.counts.x;
#endif
}

// Of the suns, as points.
vec3 sun_light(Lobe lobe, Hidden hidden) {
    vec3 sum = vec3(0.0);
    for (int n = 0; n < sky.counts.z; ++n) {
        vec3 direction = sky_suns[n].direction.xyz;
        vec3 to_light = local_from_world(lobe.frame, world_from_sky(direction));
        if (brdf_is_above(to_light))
            sum += sky_suns[n].light.rgb * (to_light.z * visible_share(hidden, direction, to_light.z)) *
                   brdf_lobe(lobe.brdf, to_light, lobe.to_viewer);
    }
    return sum;
}

vec2 shift_of(ivec2 pixel) {
#ifdef HAS_SHIFT
    return texelFetch(sky_shift, pixel, 0).rg;
#else
    return vec2(0.0);
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(lamp_light))))
        return;
    Surface surface = surface_at(pixel);
    if (surface.material < 0)
        return;
    Lobe lobe;
    lobe.brdf = brdf_of(surface);
    if (!brdf_is_glossy(lobe.brdf))
        return;
    lobe.frame = frame_of(surface);
    lobe.to_viewer = local_from_world(lobe.frame, surface.to_viewer);
    lobe.share = sky.counts.z == 0 ? 0.0
                                   : suns_in_maps(brdf_lobe_width_rad(lobe.brdf, lobe.to_viewer),
                                                  sky.intensity_sun.y);
    Hidden hidden = hidden_at(pixel);
    vec2 shift = shift_of(pixel);
    uint count = uint(count_of(lobe, pixel));
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < count; ++i) {
        vec2 xi = fract(hammersley_point(i, count) + shift);
        vec3 to_light = brdf_lobe_sample(lobe.brdf, lobe.to_viewer, xi);
        float density = brdf_lobe_density(lobe.brdf, to_light, lobe.to_viewer);
        if (!(density > 0.0))
            continue;
        vec3 direction = in_environment(lobe, to_light);
        sum += filtered_light(lobe, float(count), xi, to_light, direction, density) *
               brdf_lobe_weight(lobe.brdf, to_light, lobe.to_viewer) *
               visible_share(hidden, direction, to_light.z);
    }
    vec3 light = sum / float(count);
    if (lobe.share < 1.0)
        light += (1.0 - lobe.share) * sun_light(lobe, hidden);
    add_light(pixel, sky.intensity_sun.x * light, vec3(0.0));
}
