// SPDX-License-Identifier: Apache-2.0
// Adds the diffuse light of one slab by the windowed sum (formats/model/prepared.h), exact in float.
//
// Two programs run one after the other. Without BY_PIECES: receivers that all of U is in front of,
// by moments, 2 multiply-adds a texel and row of cells. With BY_PIECES: those whose plane cuts cells
// of U, cells in front by moments and the others pair by pair of pieces; with radiance weighting
// also those that see texels too wide for one node, and all cells by pieces. What is not done yet of
// a pixel is in lamp_irradiance's alpha.
//
// What the CPU tells: QUADS, of texels along x whose weights are kept; CELLS, n, with shadows.
//
// HAS_COLOR: the slab has three channels. IS_RADIANCE: radiance weighting. Shadows:
// sum_visibility.glsl. q > 0: the slab is level mip.x of its images, averaged until windows span
// at most q texels; pixels of other levels are left to their dispatch.
#include "render/shaders/sum_view.glsl"
#include "render/shaders/sum_visibility.glsl"
#include "render/shaders/surface.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) uniform restrict image2D lamp_light;
layout(binding = 1, rgba32f) uniform restrict image2D lamp_irradiance;

layout(location = 0) uniform float dim;
layout(location = 1) uniform ivec3 mip;  // this level, the coarsest, q
layout(location = 2) uniform ivec2 finest_texels;
layout(location = 3) uniform bool is_first;  // dispatch of this slab and level
layout(location = 4) uniform int first_row;  // of the rows that are dispatched

// Not 0: pixels are left to the program by moments, by pieces.
layout(std430, binding = 7) restrict buffer Left { uint is_left[2]; };

layout(binding = 20) uniform samplerBuffer sum_quads;

// Four neighbors of a row of an image, in every channel.
#ifdef HAS_COLOR
#define Light vec3
struct Quad { vec4 r, g, b; };
#else
#define Light float
struct Quad { vec4 y; };
#endif

int quads_of_row() { return (slab.grid_texels.z + 3) / 4; }

// Where quad i of row j of an image is, in its first channel.
int place_of_quad(int image, int i, int j) {
    return (image * slab.grid_texels.w + min(j, slab.grid_texels.w - 1)) * quads_of_row() + i;
}

Quad quad_at(int place) {
    Quad quad;
#ifdef HAS_COLOR
    int channel = image_count() * slab.grid_texels.w * quads_of_row();
    quad.r = texelFetch(sum_quads, place);
    quad.g = texelFetch(sum_quads, place + channel);
    quad.b = texelFetch(sum_quads, place + 2 * channel);
#else
    quad.y = texelFetch(sum_quads, place);
#endif
    return quad;
}

Light quad_dot(Quad quad, vec4 weights) {
#ifdef HAS_COLOR
    return vec3(dot(quad.r, weights), dot(quad.g, weights), dot(quad.b, weights));
#else
    return dot(quad.y, weights);
#endif
}

Light texel_light(int image, int i, int j) {
    ivec4 is_it = ivec4(equal(ivec4(i & 3), ivec4(0, 1, 2, 3)));
    return quad_dot(quad_at(place_of_quad(image, i >> 2, j)), vec4(is_it));
}

#include "render/shaders/sum_cell.glsl"

// As model::level_for, receiver by receiver.
int level_for(float height_m) {
    if (mip.z == 0)
        return 0;
    vec2 finest_texel_m = slab.s_min_texel_m.zw * exp2(-float(mip.x));
    float cells = float(cell_count());
    float x = window_texels(cells, slab.pitch_delta_m.x, finest_texel_m.x, delta_m(), height_m);
    float y = window_texels(cells, slab.pitch_delta_m.y, finest_texel_m.y, delta_m(), height_m);
    return mip_level(max(min(x, float(finest_texels.x)), min(y, float(finest_texels.y))),
                     float(mip.z), mip.y);
}

bool kernel_varies(SumView view) {
#ifdef IS_RADIANCE
    vec2 texel_t = abs(vec2(view.x.s_keep + view.x.s_slope, view.y.s_keep + view.y.s_slope)) *
                   slab.s_min_texel_m.zw * view.scale;
    vec2 cell_t = slab.pitch_delta_m.xy * vec2(cell_count(), 1) * view.x.cell_scale * view.scale;
    vec2 widest_t = min(texel_t, cell_t);
    return max(widest_t.x, widest_t.y) > kWidestCentroidTexelT * exp2(float(mip.x));
#else
    return false;
#endif
}

// What is done of a pixel: blocks of texel columns, of all columns of cells in turn. As alpha: 0
// for a pixel that nothing is left of.
struct Progress {
    bool by_pieces;
    int blocks;
};
float alpha_of(Progress progress) {
    return float(1 + 2 * progress.blocks + (progress.by_pieces ? 1 : 0));
}
Progress progress_of(float alpha) {
    int code = int(alpha) - 1;
    Progress progress;
    progress.by_pieces = code % 2 == 1;
    progress.blocks = code / 2;
    return progress;
}

struct PartialSum {
    Light light;
    int blocks;  // done, those before included
    bool is_whole;
};

// Light through all cells of U but what was done before: basis column by basis column (by pieces
// cell by cell along x), what weighs on a block of texel columns kept for all that they meet along y.
PartialSum sum_of_cells(SumView view, int blocks_before, vec3 world_m, vec3 world_normal) {
    PartialSum sum;
    sum.light = Light(0.0);
    sum.blocks = 0;
    int k = 0;
    do {
        see_columns_of(k, world_m, world_normal);
#ifdef BY_PIECES
        const int cells = 1;
#else
        int cells = cell_count();
#endif
        int cell_x = 0;
        do {
            CellColumn column = cell_column(view, k, cell_x, cells);
            int first = column.box.first / kAlign * kAlign;
            int count = is_empty(column.box) ? 0 : (column.box.last - first) / kBlock + 1;
            int block = clamp(blocks_before - sum.blocks, 0, count);
            sum.blocks += block;
            while (block < count && work < kMostWork) {
                sum.light += sum_of_block(view, column, first + block * kBlock);
                ++sum.blocks;
                ++block;
            }
            cell_x += cells;
        } while (cell_x < cell_count() && work < kMostWork);
    } while (++k < slab.grid_texels.x && work < kMostWork);
    sum.light = max(sum.light, Light(0.0));
    sum.is_whole = work < kMostWork;
    return sum;
}

// Whether any of U is in front, and whether it takes pieces.
const int kNothing = 0, kByMoments = 1, kByPieces = 2;
int way_of(SumView view) {
    AxisBox x = whole_box_x(view), y = whole_box_y(view);
    float middle = cosine_in_middle(view, x, y), reach = cosine_reach(view, x, y);
    if (is_empty(x) || is_empty(y) || middle + reach <= 0.0)
        return kNothing;
    return middle < reach || kernel_varies(view) ? kByPieces : kByMoments;
}

void add(ivec2 pixel, Surface surface, vec3 irradiance, float alpha) {
    vec3 to_viewer = local_from_world(frame_of(surface), surface.to_viewer);
    vec3 radiance = irradiance * brdf_diffuse(brdf_of(surface), to_viewer) * kInversePi;
    vec4 light = imageLoad(lamp_light, pixel);
    imageStore(lamp_light, pixel, light + vec4(radiance, 0.0));
    vec4 before = imageLoad(lamp_irradiance, pixel);
    imageStore(lamp_irradiance, pixel, vec4(before.rgb + irradiance, alpha));
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
    if (any(greaterThanEqual(pixel, frame.size_px.xy)))
        return;
    Surface surface = surface_at(pixel);
    if (surface.material < 0)
        return;
    float alpha = imageLoad(lamp_irradiance, pixel).a;
    if (!is_first && alpha == 0.0)
        return;
    vec3 position_m = slab_position(surface.position_m);
    if (!(position_m.z > -delta_m()) || level_for(position_m.z) != mip.x)
        return;
    SumView view = sum_view(position_m, slab_direction(surface.normal));
    Progress progress = progress_of(alpha);
    if (is_first) {
        int way = way_of(view);
        if (way == kNothing)
            return;
        progress.by_pieces = way == kByPieces;
        progress.blocks = 0;
    }
#ifdef BY_PIECES
    if (!progress.by_pieces)
        return;
#else
    if (progress.by_pieces) {
        is_left[1] = 1u;
        add(pixel, surface, vec3(0.0), alpha_of(progress));
        return;
    }
#endif
    PartialSum sum = sum_of_cells(view, progress.blocks, surface.position_m, surface.normal);
    progress.blocks = sum.blocks;
    if (!sum.is_whole)
        is_left[progress.by_pieces ? 1 : 0] = 1u;
#ifdef IS_RADIANCE
    float weighting = 1.0;
#else
    float weighting = delta_m() * delta_m();
#endif
    add(pixel, surface, vec3(dim * weighting * sum.light), sum.is_whole ? 0.0 : alpha_of(progress));
}
