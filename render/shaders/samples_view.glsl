// SPDX-License-Identifier: Apache-2.0
// A receiver's view of one slab, and what is drawn from it: images, or (image, cell of U) pairs. As
// formats/model/sampler_look.cpp and sampler_window.cpp.
//
// SAMPLER, SEQUENCE, SHIFT: numbers of model::Sampler, Sequence and Shift.
#include "formats/shared/basis.glsl.h"
#include "formats/shared/draw.glsl.h"
#include "formats/shared/light_kernel.glsl.h"
#include "formats/shared/stored_cdf.glsl.h"
#include "render/shaders/slab.glsl"

#define UNIFORM 0
#define PRECOMPUTED 1
#define PDIS 2
#define SYSTEMATIC 3
#define CELLS 4
#ifndef SAMPLER
#define SAMPLER SYSTEMATIC
#endif
#ifndef SEQUENCE
#define SEQUENCE 1
#endif
#ifndef SHIFT
#define SHIFT 1
#endif

// A frame is drawn in bands of rows, so that these stay small. Energies are negative where the
// tables do not resolve a box, and its texels are summed.
layout(std430, binding = 5) restrict buffer Energies { float energies[]; };  // [entry][pixel]
// The lamp's running sum before its first slab and after each.
layout(std430, binding = 6) restrict buffer RunningTotals { double running_totals[]; };  // [slab + 1][pixel]

layout(location = 1) uniform ivec4 band;  // first row, rows, width, pixels
layout(location = 2) uniform ivec4 part;  // the slab's first entry, the lamp's entries, slab, slabs

ivec2 band_pixel() { return ivec2(gl_GlobalInvocationID.xy) + ivec2(0, band.x); }
bool is_in_band() { return gl_GlobalInvocationID.x < band.z && gl_GlobalInvocationID.y < band.y; }
int index_in_band() { return int(gl_GlobalInvocationID.y) * band.z + int(gl_GlobalInvocationID.x); }

float energy_of_lamp(int entry) { return energies[entry * band.w + index_in_band()]; }
float energy_of(int entry) { return energy_of_lamp(part.x + entry); }
double running_total(int slabs) { return running_totals[slabs * band.w + index_in_band()]; }

// In the slab's frame.
struct SlabView {
    vec3 position_m, normal;
    AxisView x, y;
    AxisTexels x_texels, y_texels;
};

SlabView slab_view(vec3 world_m, vec3 normal_world) {
    SlabView view;
    view.position_m = slab_position(world_m);
    view.normal = slab_direction(normal_world);
    view.x = axis_view(view.position_m.x, delta_m(), view.position_m.z);
    view.y = axis_view(view.position_m.y, delta_m(), view.position_m.z);
    view.x_texels = axis_texels(0, view.position_m.z);
    view.y_texels = axis_texels(1, view.position_m.z);
    return view;
}

// Edge k of U's cells along an axis. Where lanes read a buffer at different places it costs a SIMD
// machine as much as a step of a search: computed, 1e-7 of a pitch off. At supports' edges Phi is
// small; cells' edges are the buffer's, so that no sample changes its cell.
float cell_edge_m(int axis, int k) {
#if SAMPLER == CELLS
    return u_edge_m(axis, k);
#else
    return u_edge_m(axis, 0) + float(k) * slab.pitch_delta_m[axis];
#endif
}

// What a run of U's cells shows along an axis.
AxisBox cells_box_x(SlabView view, int first_cell, int cells) {
    return axis_box(view.x, view.x_texels, cell_edge_m(0, first_cell),
                    cell_edge_m(0, first_cell + cells));
}
AxisBox cells_box_y(SlabView view, int first_cell, int cells) {
    return axis_box(view.y, view.y_texels, cell_edge_m(1, first_cell),
                    cell_edge_m(1, first_cell + cells));
}

// Whether the receiver is before U and anything that it sees of it before the receiver.
bool sees_light(SlabView view) {
    AxisBox x = cells_box_x(view, 0, slab.grid_texels.x + cell_count() - 1);
    AxisBox y = cells_box_y(view, 0, slab.grid_texels.y + cell_count() - 1);
    vec2 reach_x = view.normal.x * vec2(t_of_e(view.x, x.e_lo), t_of_e(view.x, x.e_hi));
    vec2 reach_y = view.normal.y * vec2(t_of_e(view.y, y.e_lo), t_of_e(view.y, y.e_hi));
    return view.position_m.z > -delta_m() && x.first <= x.last && y.first <= y.last &&
           max(reach_x.x, reach_x.y) + max(reach_y.x, reach_y.y) > view.normal.z;
}

// What an energy is of: an image, or one cell of its support.
struct Entry {
    int image;
    ivec2 basis;  // its column and row
    ivec2 cell;
};

int entry_count() { return image_count() * (SAMPLER == CELLS ? cell_count() * cell_count() : 1); }

Entry first_cell_of(int image, ivec2 basis) {
    Entry entry;
    entry.image = image;
    entry.basis = basis;
    entry.cell = ivec2(0);
    return entry;
}
Entry first_cell_of_image(int image) {
    return first_cell_of(image, ivec2(image % slab.grid_texels.x, image / slab.grid_texels.x));
}

// Energies are in this order: [row][column][cell along y][cell along x].
Entry next_entry(Entry entry) {
#if SAMPLER == CELLS
    entry.cell.x += 1;
    bool is_row_done = entry.cell.x == cell_count();
    entry.cell = is_row_done ? ivec2(0, entry.cell.y + 1) : entry.cell;
    if (entry.cell.y < cell_count())
        return entry;
#endif
    bool is_last = entry.basis.x + 1 == slab.grid_texels.x;
    return first_cell_of(entry.image + 1, is_last ? ivec2(0, entry.basis.y + 1)
                                                  : entry.basis + ivec2(1, 0));
}

// By what an energy is weighted.
float mean_basis(Entry entry) {
    return SAMPLER == CELLS ? slab.profile[entry.cell.x].w * slab.profile[entry.cell.y].w : 1.0;
}

AxisBox entry_box_x(SlabView view, Entry entry) {
    return cells_box_x(view, entry.basis.x + entry.cell.x, SAMPLER == CELLS ? 1 : cell_count());
}
AxisBox entry_box_y(SlabView view, Entry entry) {
    return cells_box_y(view, entry.basis.y + entry.cell.y, SAMPLER == CELLS ? 1 : cell_count());
}

float delta2_or_1() { return has_radiance_weighting() ? 1.0 : delta_m() * delta_m(); }
float texel_area_m2() { return slab.s_min_texel_m.z * slab.s_min_texel_m.w; }
// From int C_m dt times the area of a texel to illuminance.
float energy_scale() { return delta2_or_1() / texel_area_m2(); }

bool is_lit(int image, AxisBox x, AxisBox y) {
    ivec4 lit = slab_lit[image];
    return x.first <= x.last && y.first <= y.last && x.first < lit.z && x.last >= lit.x &&
           y.first < lit.w && y.last >= lit.y;
}

// Phi_m(u).
float basis_along(int axis, int k, float u_m) {
    float center_m = cell_edge_m(axis, k) + 0.5 * float(cell_count()) * slab.pitch_delta_m[axis];
    float x = (u_m - center_m) / slab.pitch_delta_m[axis];
    int cell = int(clamp(profile_cell(x, float(cell_count())), -1.0, float(cell_count())));
    vec4 phi = slab.profile[clamp(cell, 0, cell_count() - 1)];
    return cell >= 0 && cell < cell_count() ? profile_value(x, phi.x, phi.y, phi.z) : 0.0;
}
float basis_at(ivec2 basis, vec2 u_m) {
    return basis_along(0, basis.x, u_m.x) * basis_along(1, basis.y, u_m.y);
}

// C_m over its luminance.
vec3 color_of_texel(int image, ivec2 texel) {
    return texel_chroma(image, texel.x, texel.y);
}

// Where tables do not resolve a box, as formats/model/sampler_window.cpp: a column's light by its
// texels, and the box'.
float column_by_texels(int image, AxisBox x, AxisBox y, int i) {
    float column = 0.0;
    for (int j = y.first; j <= y.last; ++j)
        column += texel_width(y, j) * texel_luminance(image, i, j);
    return column;
}
float energy_by_texels(int image, AxisBox x, AxisBox y) {
    float sum = 0.0;
    for (int i = x.first; i <= x.last; ++i)
        sum += column_by_texels(image, x, y, i) * (texel_width(x, i) * texel_area_m2());
    return sum;
}

// pick_in_box for such a box, whose energy is known. A texel of 0 is never chosen.
BoxPick pick_by_texels(int image, AxisBox x, AxisBox y, float energy, vec2 coordinates) {
    BoxPick pick;
    pick.texel = ivec2(-1);
    pick.fraction = vec2(0.5);
    pick.steps = 0;
    float left = coordinates.x * energy, column = 0.0;
    for (int i = x.first; i <= x.last; ++i) {
        float own = column_by_texels(image, x, y, i);
        float value = own * (texel_width(x, i) * texel_area_m2());
        if (!(value > 0.0))
            continue;
        pick.texel.x = i;
        pick.fraction.x = fraction_of(left, value);
        column = own;
        if (left < value)
            break;
        left -= value;
    }
    left = coordinates.y * column;
    for (int j = y.first; j <= y.last && pick.texel.x >= 0; ++j) {
        float value = texel_width(y, j) * texel_luminance(image, pick.texel.x, j);
        if (!(value > 0.0))
            continue;
        pick.texel.y = j;
        pick.fraction.y = fraction_of(left, value);
        if (left < value)
            break;
        left -= value;
    }
    return pick;
}

AperturePoint aperture_point(SlabView view, AxisBox x, AxisBox y, BoxPick pick) {
    return aperture_at(view.x, view.y,
                       vec2(e_in_box(view.x, view.x_texels, x, pick.texel.x, pick.fraction.x),
                            e_in_box(view.y, view.y_texels, y, pick.texel.y, pick.fraction.y)));
}

float cdf_at(StoredCdf cdf, int i) {
    return cdf.column < 0 ? marginal_cdf(cdf.image, i) : conditional_cdf(cdf.image, cdf.column, i);
}
StoredCdf stored_cdf(int image, int column) {
    StoredCdf cdf;
    cdf.image = image;
    cdf.column = column;
    return cdf;
}
