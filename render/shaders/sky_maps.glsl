// SPDX-License-Identifier: Apache-2.0
// Orthographic shadow maps of the environment's directions. Bound by render/gpu/sky_maps.cpp.

layout(binding = 3) uniform sampler2DArray sky_depth;  // 0 ... 1 towards the light; 0: nothing

// clip_from_world of each direction: x, y in -1 ... 1 on the map, z 0 ... 1 towards the light.
layout(std430, binding = 6) readonly restrict buffer SkyViews { mat4 sky_views[]; };

// What lies less than so many widths of a texel before the receiver's plane casts no shadow.
const float kSkyBias = 1.5;

// Share of the 2 x 2 texels about a position that nothing stands before. As shadows.glsl, the
// receiver's plane is followed towards the light alone.
float sky_is_open(int view, vec3 world_m, vec3 normal) {
    mat4 clip_from_world = sky_views[view];
    vec3 p = (clip_from_world * vec4(world_m, 1.0)).xyz;
    mat3 turn = mat3(clip_from_world);
    // Of the rows: what a metre along x, y and towards the light is in the map.
    vec3 scale = vec3(length(vec3(turn[0].x, turn[1].x, turn[2].x)),
                      length(vec3(turn[0].y, turn[1].y, turn[2].y)),
                      length(vec3(turn[0].z, turn[1].z, turn[2].z)));
    vec3 n = turn * normal / (scale * scale);  // plane: n . (q - p) = 0 in the map's units
    vec2 px = vec2(textureSize(sky_depth, 0).xy);
    vec2 texel_clip = 2.0 / px;
    float bias = kSkyBias * scale.z * max(texel_clip.x / scale.x, texel_clip.y / scale.y);
    vec2 slope = n.z > 0.0 ? -n.xy / n.z * texel_clip : vec2(0.0);  // of depth, by texel
    vec2 corner = (0.5 * p.xy + 0.5) * px - 0.5;
    ivec2 first = ivec2(floor(corner));
    vec2 part = corner - vec2(first);
    float open = 0.0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            float weight = (i == 0 ? 1.0 - part.x : part.x) * (j == 0 ? 1.0 - part.y : part.y);
            ivec2 texel = clamp(first + ivec2(i, j), ivec2(0), ivec2(px) - 1);
            float on_plane = p.z + max(dot(slope, vec2(first + ivec2(i, j)) - corner), 0.0);
            float found = texelFetch(sky_depth, ivec3(texel, view), 0).r;
            open += found > on_plane + bias ? 0.0 : weight;
        }
    return open;
}
