// SPDX-License-Identifier: Apache-2.0
// Whether a receiver sees a cell of the slab's U plane. Bound by render/gpu/shadow_maps.cpp.
#include "render/shaders/slab.glsl"

#ifdef HAS_SHADOWS

#ifndef SHADOW_TAPS_PER_SIDE
#define SHADOW_TAPS_PER_SIDE 2
#endif

// What lies less than so many widths of a map's texel, at the receiver's depth, before the receiver's
// plane casts no shadow: maps do not resolve it, and what is curved, or shaded smoothly, leaves its
// tangent plane by less where it is wider than two texels.
const float kBias = 1.0;
struct ShadowCell {
    vec4 eye_world_m_view;  // w: its map; -1: it sends no light
    vec4 tangents;          // least x, y; 1 / extent
};
layout(std430, binding = 4) readonly restrict buffer ShadowCells {
    vec4 shadow_nearest_m;  // x: of the maps' depths
    ShadowCell shadow_cells[];
};
layout(binding = 3) uniform sampler2DArray shadow_depth;  // nearest / depth along the slab's axis

// Share of a box of (n - 1) x (n - 1) texels about `at_px` that nothing stands before; n = 1: of
// the texel. own: nearest / depth of the receiver; on_plane: of its plane at the map's corner, and
// by texel. The plane is followed towards the eye alone: what is farther than the receiver hides
// nothing from it.
float lit_share(int view, vec2 at_px, float own, vec3 on_plane) {
    const int n = SHADOW_TAPS_PER_SIDE;
    vec2 corner = at_px - 0.5 * float(n - 1);
    ivec2 first = ivec2(floor(corner));
    vec2 part = corner - vec2(first);
    ivec2 last = textureSize(shadow_depth, 0).xy - 1;
    float lit = 0.0;
    for (int j = 0; j < n; ++j) {
        float row = n == 1 ? 1.0 : j == 0 ? 1.0 - part.y : j == n - 1 ? part.y : 1.0;
        for (int i = 0; i < n; ++i) {
            float weight = n == 1 ? 1.0 : row * (i == 0 ? 1.0 - part.x : i == n - 1 ? part.x : 1.0);
            ivec2 texel = clamp(first + ivec2(i, j), ivec2(0), last);
            float on_texel = on_plane.x + dot(on_plane.yz, vec2(texel) + 0.5);
            float found = texelFetch(shadow_depth, ivec3(texel, view), 0).r;
            lit += found > max(own, on_texel) ? 0.0 : weight;
        }
    }
    return n == 1 ? lit : lit / float((n - 1) * (n - 1));
}

// 0 ... 1; -1 where the cell's map does not show the receiver.
float mapped_visibility(ivec2 cell, vec3 world_m, vec3 normal) {
    ShadowCell of = shadow_cells[cell.y * (slab.grid_texels.x + cell_count() - 1) + cell.x];
    if (of.eye_world_m_view.w < 0.0) {
        return 1.0;
    }
    vec3 p = slab_direction(world_m - of.eye_world_m_view.xyz);
    vec2 tangent = p.xy / p.z;
    vec2 at = (tangent - of.tangents.xy) * of.tangents.zw;
    if (!(p.z > shadow_nearest_m.x) || any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(1.0)))) {
        return -1.0;
    }
    // The receiver's plane: n . q = n . p, hence 1 / depth = n . (t, 1) / n . p, linear in t.
    vec2 px = vec2(textureSize(shadow_depth, 0).xy);
    vec2 texel = 1.0 / (of.tangents.zw * px);
    vec3 n = slab_direction(normal);
    float toward = n.z + dot(n.xy, tangent);
    float steep = abs(toward) > 1e-6 ? 1.0 / toward : 0.0;
    float own = shadow_nearest_m.x / p.z * (1.0 + kBias * max(texel.x, texel.y));
    vec2 slope = own * steep * n.xy * texel;
    vec3 on_plane = vec3(own - dot(slope, at * px), slope);
    return lit_share(int(of.eye_world_m_view.w), at * px, own, on_plane);
}

#else

// Nothing stands between: no map, no fetch.
float mapped_visibility(ivec2 cell, vec3 world_m, vec3 normal) {
    return 1.0;
}

#endif

// What maps do not show is lit.
float cell_visibility(ivec2 cell, vec3 world_m, vec3 normal) {
    float found = mapped_visibility(cell, world_m, normal);
    return found < 0.0 ? 1.0 : found;
}
