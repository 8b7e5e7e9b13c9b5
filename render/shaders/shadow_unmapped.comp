// SPDX-License-Identifier: Apache-2.0
// Counts receivers between the planes S and U, in the space that the slab may light, that the map of
// some cell with light does not show.
#include "render/shaders/surface.glsl"
#include "render/shaders/shadows.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, binding = 5) restrict buffer Unmapped { uint unmapped; };

// Bounds of the hull of S' and U's rectangles at a height z = -delta ... 0.
bool is_between_planes(vec3 p) {
    if (!(p.z > -delta_m() && p.z < 0.0)) {
        return false;
    }
    ivec2 cells = slab.grid_texels.xy + cell_count() - 1;
    vec2 u_low = vec2(u_edge_m(0, 0), u_edge_m(1, 0));
    vec2 u_high = vec2(u_edge_m(0, cells.x), u_edge_m(1, cells.y));
    vec2 s_low = slab.s_min_texel_m.xy;
    vec2 s_high = s_low + vec2(slab.grid_texels.zw) * slab.s_min_texel_m.zw;
    float share = -p.z / delta_m();  // 0 on S, 1 on U
    return all(greaterThanEqual(p.xy, mix(s_low, u_low, share))) &&
           all(lessThanEqual(p.xy, mix(s_high, u_high, share)));
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, frame.size_px.xy))) {
        return;
    }
    Surface surface = surface_at(pixel);
    if (surface.material < 0 || !is_between_planes(slab_position(surface.position_m))) {
        return;
    }
    ivec2 cells = slab.grid_texels.xy + cell_count() - 1;
    for (int k = 0; k < cells.x * cells.y; ++k) {
        ivec2 cell = ivec2(k % cells.x, k / cells.x);
        if (mapped_visibility(cell, surface.position_m, surface.normal) < 0.0) {
            atomicAdd(unmapped, 1u);
            return;
        }
    }
}
