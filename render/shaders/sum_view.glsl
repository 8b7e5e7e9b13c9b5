// SPDX-License-Identifier: Apache-2.0
// A receiver in the slab's frame, and how the slab lies to it.
#include "formats/shared/pieces.glsl.h"
#include "render/shaders/slab.glsl"

// What does not depend on the receiver, in a texture: llvmpipe reads buffers a pixel after the other.
// Rows: of images, first texel with light (x, y) and one past the last (z, w), all 0: none; of U's
// cells along x and along y, both edges (x, y) and the center of the basis function (z), in metres.
layout(binding = 21) uniform sampler2D sum_tables;

ivec4 lit_of(int image) { return ivec4(texelFetch(sum_tables, ivec2(image, 0), 0)); }
vec2 cell_edges_m(int axis, int cell) {
    return texelFetch(sum_tables, ivec2(cell, 1 + axis), 0).xy;
}
float center_m(int axis, int basis) { return texelFetch(sum_tables, ivec2(basis, 1 + axis), 0).z; }

struct SumView {
    vec3 normal;
    AxisView x, y;
    AxisTexels s_x, s_y;
    float plane, scale;  // n.(t, -1) = (n_x e_x + n_y e_y + plane) scale
};

SumView sum_view(vec3 position_m, vec3 normal) {
    SumView view;
    view.normal = normal;
    view.x = axis_view(position_m.x, delta_m(), position_m.z);
    view.y = axis_view(position_m.y, delta_m(), position_m.z);
    view.s_x = axis_texels(0, position_m.z);
    view.s_y = axis_texels(1, position_m.z);
    view.scale = view.x.t_scale;
    // Where e is u, n.(u - p) of points on U. In double: far away all of it is the difference of
    // p's large coordinates.
    bool e_is_u = view.x.s_keep > 0.5;
    view.plane = e_is_u ? float(-dot(dvec3(normal), dvec3(position_m)) -
                                double(normal.z) * double(delta_m()))
                        : -normal.z;
    return view;
}

// n.(t, -1) in the middle of a rectangle of e, and how far it goes up and down from there.
float cosine_in_middle(SumView view, AxisBox x, AxisBox y) {
    return (view.normal.x * 0.5 * (x.e_lo + x.e_hi) + view.normal.y * 0.5 * (y.e_lo + y.e_hi) +
            view.plane) * view.scale;
}
float cosine_reach(SumView view, AxisBox x, AxisBox y) {
    return 0.5 * view.scale *
           (abs(view.normal.x) * (x.e_hi - x.e_lo) + abs(view.normal.y) * (y.e_hi - y.e_lo));
}

bool is_empty(AxisBox box) { return box.last < box.first; }

// U's cells along an axis: W + n - 1 or H + n - 1.
int cells_along(int axis) { return slab.grid_texels[axis] + cell_count() - 1; }

// What is seen through one cell of U along y, and through all along an axis.
AxisBox box_of_cell_y(SumView view, int cell) {
    vec2 edges_m = cell_edges_m(1, cell);
    return axis_box(view.y, view.s_y, edges_m.x, edges_m.y);
}
AxisBox whole_box_x(SumView view) {
    return axis_box(view.x, view.s_x, cell_edges_m(0, 0).x,
                    cell_edges_m(0, cells_along(0) - 1).y);
}
AxisBox whole_box_y(SumView view) {
    return axis_box(view.y, view.s_y, cell_edges_m(1, 0).x,
                    cell_edges_m(1, cells_along(1) - 1).y);
}

// One axis of a basis function on one of its cells.
struct CellPhi {
    vec3 a;  // phi = a.x + a.y x + a.z x^2
    float center_m, inv_pitch;
};
CellPhi cell_phi(int axis, int basis, int cell) {
    CellPhi phi;
    phi.a = slab.profile[cell].xyz;
    phi.center_m = center_m(axis, basis);
    phi.inv_pitch = 1.0 / slab.pitch_delta_m[axis];
    return phi;
}

// Moments of texel i's part of a cell, with tangents counted from e_c, the middle of what is seen:
// about that the cosine is known to all its digits, however far away the receiver is.
CellMoments texel_moments(AxisView view, AxisTexels s, Interval cell, float e_c, CellPhi phi, int i) {
    Interval part = texel_part(view, s, cell.lo, cell.hi, i);
    view.t_origin = e_c;
    float lo = min(part.lo, cell.hi);  // a texel beyond the cell may be anywhere
    return cell_moments(view, lo, max(lo, part.hi), phi.a.x, phi.a.y, phi.a.z,
                        phi.center_m, phi.inv_pitch);
}

PhiPiece texel_piece(AxisView view, Interval part, CellPhi phi) {
    return phi_piece(view, part.lo, part.hi, phi.a.x, phi.a.y, phi.a.z, phi.center_m,
                     phi.inv_pitch);
}
