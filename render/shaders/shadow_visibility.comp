// SPDX-License-Identifier: Apache-2.0
// What the shadow maps say of every cell and pixel: for measurement.
#include "render/shaders/surface.glsl"
#include "render/shaders/shadows.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std430, binding = 5) writeonly restrict buffer Visibilities { float visibilities[]; };
layout(location = 0) uniform int cells;

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);  // cell, pixel
    if (at.x >= cells || at.y >= frame.size_px.x * frame.size_px.y) {
        return;
    }
    Surface surface = surface_at(ivec2(at.y % frame.size_px.x, at.y / frame.size_px.x));
    int columns = slab.grid_texels.x + cell_count() - 1;
    ivec2 cell = ivec2(at.x % columns, at.x / columns);
    float found = 1.0;
    if (surface.material >= 0) {
        found = cell_visibility(cell, surface.position_m, surface.normal);
        if (mapped_visibility(cell, surface.position_m, surface.normal) < 0.0) {
            found = -found;
        }
    }
    visibilities[at.y * cells + at.x] = found;
}
