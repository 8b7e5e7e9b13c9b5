// SPDX-License-Identifier: Apache-2.0
// The slab that is being shaded: its planes, basis and images. Bound by render/gpu/slab_textures.cpp.
#include "formats/shared/portable.glsl.h"
#include "formats/shared/window.glsl.h"
#include "formats/shared/restricted.glsl.h"

const int kMostCells = 32;

layout(std140, binding = 1) uniform SlabBlock {
    dmat4 slab_from_world;  // in double: 1e-6 m off at 16 m is 1e-4 of the light on a cut-off line
    mat4 world_from_slab;
    mat4 turn;            // rotation of slab_from_world, perhaps mirrored, without its scale
    vec4 s_min_texel_m;   // S: least corner x, y; a texel's size x, y
    vec4 pitch_delta_m;   // U: pitch x, y; the planes' distance; 1 with radiance weighting, else 0
    ivec4 grid_texels;    // W, H; w, h
    ivec4 cells_channels; // n; channels of coeffs; 1 with chroma, else 0; images
    vec4 profile[kMostCells];  // [cell]: a0, a1, a2, mean of phi over the cell
} slab;

// U's cells along x: lower edges of all W + n - 1 and the upper of the last, then along y; then
// centers of the basis functions along x, then y. In metres.
layout(std430, binding = 1) readonly restrict buffer SlabEdges { float slab_edges[]; };
// First texel with light (x, y) and one past the last (z, w) of every image; all 0: none.
layout(std430, binding = 2) readonly restrict buffer SlabLit { ivec4 slab_lit[]; };
// Integral of C_m over S, m^2 times C_m, of every image.
layout(std430, binding = 3) readonly restrict buffer SlabTotals { float slab_totals[]; };

layout(binding = 8) uniform sampler2DArray slab_coeffs;
layout(binding = 9) uniform sampler2DArray slab_luminance;
layout(binding = 10) uniform sampler2DArray slab_chroma;
layout(binding = 12) uniform sampler2D slab_marginal;
layout(binding = 13) uniform sampler2DArray slab_conditional;
// An image, since samplers read little else: llvmpipe takes two thirds longer over a texture.
layout(binding = 7, rg32f) uniform readonly restrict image2DArray slab_area;

int cell_count() { return slab.cells_channels.x; }
int image_count() { return slab.cells_channels.w; }
float delta_m() { return slab.pitch_delta_m.z; }
bool has_radiance_weighting() { return slab.pitch_delta_m.w > 0.5; }

// Edge k of U's cells along an axis (0: x, 1: y), k = 0 ... W + n - 1.
float u_edge_m(int axis, int k) {
    return slab_edges[axis == 0 ? k : slab.grid_texels.x + cell_count() + k];
}
float u_center_m(int axis, int k) {
    int edges = slab.grid_texels.x + slab.grid_texels.y + 2 * cell_count();
    return slab_edges[edges + (axis == 0 ? k : slab.grid_texels.x + k)];
}

// A receiver in the slab's frame.
vec3 slab_position(vec3 world_m) {
    return vec3((slab.slab_from_world * dvec4(world_m, 1.0)).xyz);
}
vec3 slab_direction(vec3 world) { return mat3(slab.turn) * world; }

AxisTexels axis_texels(int axis, float height_m) {
    AxisTexels s;
    s.s_min = slab.s_min_texel_m[axis];
    s.texel = slab.s_min_texel_m[2 + axis];
    s.delta = delta_m();
    s.height = height_m;
    s.texels = slab.grid_texels[2 + axis];
    return s;
}

float coeff(int channel, int image, int i, int j) {
    return texelFetch(slab_coeffs, ivec3(i, j, channel * image_count() + image), 0).r;
}

float texel_luminance(int image, int i, int j) {
    return texelFetch(slab_luminance, ivec3(i, j, image), 0).r;
}

// C_m over its luminance.
vec3 texel_chroma(int image, int i, int j) {
#ifdef HAS_COLOR
    if (slab.cells_channels.z == 1) {
        vec2 rb = texelFetch(slab_chroma, ivec3(i, j, image), 0).rg;
        float green = (1.0 - 0.2126 * rb.x - 0.0722 * rb.y) / 0.7152;  // below 0 by rounding
        return vec3(rb.x, max(green, 0.0), rb.y);
    }
#endif
    return vec3(1.0);
}

AreaTable area_table(int image) {
    AreaTable table;
    table.first = image;
    table.row_stride = 0;
    return table;
}

Pair corner(AreaTable table, int i, int j) {
    vec2 value = imageLoad(slab_area, ivec3(i, j, table.first)).rg;
    Pair pair;
    pair.hi = value.x;
    pair.lo = value.y;
    return pair;
}

float marginal_cdf(int image, int i) { return texelFetch(slab_marginal, ivec2(i, image), 0).r; }
float conditional_cdf(int image, int column, int j) {
    return texelFetch(slab_conditional, ivec3(j, column, image), 0).r;
}
