// SPDX-License-Identifier: Apache-2.0
// Images restricted to the box that a basis function shows a receiver: their energy, and its
// inverse.
//
// A box is texels first ... last along an axis: the part of `first` and `last` that it holds, and
// whole texels between, each by its width in tangents. So no corner of the summed-area table is
// interpolated: all corners are exact, and their differences too (pair.glsl.h).
//
// In C++ include formats/model/axis_window.h first: window.glsl.h has no guard there.
#ifndef NEARFIELD_RESTRICTED_GLSL_H
#define NEARFIELD_RESTRICTED_GLSL_H

#include "formats/shared/pair.glsl.h"
#include "formats/shared/portable.glsl.h"
#ifndef __cplusplus
#include "formats/shared/window.glsl.h"
#endif

SHARED_BEGIN

// An image's summed-area table: where it is, as each side keeps it, and how a corner is read: the
// integral of C_m over texels x < i, y < j, in m^2.
#ifdef __cplusplus
struct AreaTable {
    const float* hi;
    const float* lo;  // null: hi alone
    int row_stride;
};
inline Pair corner(AreaTable table, int i, int j) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(j) * table.row_stride + i;
    return {table.hi[at], table.lo == nullptr ? 0.0F : table.lo[at]};
}
#else
struct AreaTable {
    int first, row_stride;
};
Pair corner(AreaTable table, int i, int j);
#endif

// One axis of S and the planes' distances.
struct AxisTexels {
    float s_min, texel, delta, height;
    int texels;
};

// What part of one axis of an image a piece of U shows a receiver.
struct AxisBox {
    int first, last;    // texels, inclusive; last < first: nothing
    float e_lo, e_hi;   // the box's ends in the coordinate e of its AxisView
    float first_width;  // of t, of texel `first` (all there is where first == last)
    float last_width;   // of t, of texel `last`; 0 where first == last
    float texel_width;  // of t, of every texel between
};

struct Interval {
    float lo, hi;
};

// Texel i's part of [e_lo, e_hi], in e; lo >= hi where it has none.
GPU_FN Interval texel_part(AxisView view, AxisTexels s, float e_lo, float e_hi, int i) {
    float a = e_of_s(view, s.s_min + float(i) * s.texel);
    float b = e_of_s(view, s.s_min + float(i + 1) * s.texel);
    Interval part;
    part.lo = max(e_lo, min(a, b));
    part.hi = min(e_hi, max(a, b));
    return part;
}

// The texel that a position on S is in, `margin` of a texel further on; clamped to [-1, texels].
// Clamped before the conversion: just above U a window spans 1e7 times S.
GPU_FN int texel_of_s(AxisTexels s, float position, float margin) {
    return int(clamp(floor((position - s.s_min) / s.texel + margin), -1.0f, float(s.texels)));
}

// The box that [u_lo, u_hi] on U shows, within S.
GPU_FN AxisBox axis_box(AxisView view, AxisTexels s, float u_lo, float u_hi) {
    float at_a = s_of_u(u_lo, view.p, s.delta, s.height);
    float at_b = s_of_u(u_hi, view.p, s.delta, s.height);
    // A texel that is missed by rounding counts in; whether it has a part is asked below.
    AxisBox box;
    box.first = max(texel_of_s(s, min(at_a, at_b), -0.015625f), 0);
    box.last = min(texel_of_s(s, max(at_a, at_b), 0.015625f), s.texels - 1);
    float edge_a = e_of_s(view, s.s_min);
    float edge_b = e_of_s(view, s.s_min + float(s.texels) * s.texel);
    box.e_lo = max(e_of_u(view, u_lo), min(edge_a, edge_b));
    box.e_hi = min(e_of_u(view, u_hi), max(edge_a, edge_b));
    box.texel_width = abs(view.s_keep + view.s_slope) * s.texel * view.t_scale;
    Interval first = texel_part(view, s, box.e_lo, box.e_hi, box.first);
    if (!(first.lo < first.hi)) {
        box.first = box.first + 1;
        first = texel_part(view, s, box.e_lo, box.e_hi, box.first);
    }
    Interval last = texel_part(view, s, box.e_lo, box.e_hi, box.last);
    if (!(last.lo < last.hi)) {
        box.last = box.last - 1;
        last = texel_part(view, s, box.e_lo, box.e_hi, box.last);
    }
    box.first_width = max(first.hi - first.lo, 0.0f) * view.t_scale;
    box.last_width = box.last > box.first ? max(last.hi - last.lo, 0.0f) * view.t_scale : 0.0f;
    if (!(box.e_lo < box.e_hi)) {
        box.last = box.first - 1;
    }
    return box;
}

GPU_FN float texel_width(AxisBox box, int i) {
    return i == box.first ? box.first_width : i == box.last ? box.last_width : box.texel_width;
}

// Corners at one edge along x, at the four edges along y that a box has: around its first texel and
// around its last.
struct EdgeCorners {
    Pair a, b, c, d;
};

GPU_FN EdgeCorners edge_corners(AreaTable table, AxisBox y, int i) {
    EdgeCorners edge;
    edge.a = corner(table, i, y.first);
    edge.b = corner(table, i, y.first + 1);
    edge.c = corner(table, i, max(y.last, y.first + 1));
    edge.d = corner(table, i, y.last + 1);
    return edge;
}

// All 16 corners of a box: around its first column and around its last.
struct BoxCorners {
    EdgeCorners a, b, c, d;
};

GPU_FN BoxCorners box_corners(AreaTable table, AxisBox x, AxisBox y) {
    BoxCorners box;
    box.a = edge_corners(table, y, x.first);
    box.b = edge_corners(table, y, x.first + 1);
    box.c = edge_corners(table, y, max(x.last, x.first + 1));
    box.d = edge_corners(table, y, x.last + 1);
    return box;
}

// int C_m over the columns between two edges, each of y's texels by its width in t: in the first
// row, the rows between and the last. Never below 0, which rounding could give for a dark box in a
// bright image.
GPU_FN vec3 row_energies(EdgeCorners left, EdgeCorners right, AxisBox y) {
    Pair a = pair_difference(right.a, left.a);
    Pair b = pair_difference(right.b, left.b);
    Pair c = pair_difference(right.c, left.c);
    Pair d = pair_difference(right.d, left.d);
    return max(vec3(y.first_width * float_difference(b, a), y.texel_width * float_difference(c, b),
                    y.last_width * float_difference(d, c)),
               vec3(0.0f));
}

GPU_FN float sum_of(vec3 parts) {
    return parts.x + parts.y + parts.z;
}

// The energies of the 3 x 3 blocks of a box, int C_m dt_x dt_y times the area of a texel: in its
// first column, those between and the last; of each by rows.
struct BoxBlocks {
    vec3 first, middle, last;
};

GPU_FN BoxBlocks box_blocks(BoxCorners box, AxisBox x, AxisBox y) {
    BoxBlocks blocks;
    blocks.first = x.first_width * row_energies(box.a, box.b, y);
    blocks.middle = x.texel_width * row_energies(box.b, box.c, y);
    blocks.last = x.last_width * row_energies(box.c, box.d, y);
    return blocks;
}

GPU_FN vec3 column_energies(BoxBlocks blocks) {
    return vec3(sum_of(blocks.first), sum_of(blocks.middle), sum_of(blocks.last));
}

// The energy of a box. Cost: 16 corners.
GPU_FN float box_energy(AreaTable table, AxisBox x, AxisBox y) {
    return sum_of(column_energies(box_blocks(box_corners(table, x, y), x, y)));
}

GPU_FN float widest_part(AxisBox box) {
    return box.last - box.first > 1 ? box.texel_width : max(box.first_width, box.last_width);
}

// Whether tables tell the energy of a box of an image that holds `total`: pairs of floats leave an
// error of about 5e-15 of that, below 1e-4 of a share of 1e-9.
GPU_FN bool is_resolved(float energy, float total, AxisBox x, AxisBox y) {
    return energy >= 1e-9f * total * widest_part(x) * widest_part(y);
}

// Where along an axis a running sum passes its target.
struct TexelPick {
    int texel;
    float fraction;  // of the texel's part of the box, in [0, 1)
    int steps;       // of the search
};

// Which of the three parts of a box a target in [0, sum) is in, and how far into it. A part without
// energy is never chosen, whatever rounding does.
struct PartPick {
    int part;  // 0, 1, 2
    float target;
};

GPU_FN PartPick pick_part(vec3 parts, float target) {
    PartPick pick;
    pick.part = 0;
    pick.target = target;
    float energy = parts.x;
    if (target >= parts.x && parts.y + parts.z > 0.0f) {
        float beyond = target - parts.x;
        bool is_last = parts.z > 0.0f && beyond >= parts.y;
        pick.part = is_last ? 2 : parts.y > 0.0f ? 1 : 2;
        pick.target = pick.part == 2 ? beyond - parts.y : beyond;
        energy = pick.part == 2 ? parts.z : parts.y;
    }
    pick.target = clamp(pick.target, 0.0f, energy * 0.99999994f);
    return pick;
}

GPU_FN float fraction_of(float part, float whole) {
    return whole > 0.0f ? clamp(part / whole, 0.0f, 0.99999994f) : 0.5f;
}

GPU_FN float part_of(vec3 parts, int part) {
    return part == 0 ? parts.x : part == 1 ? parts.y : parts.z;
}

GPU_FN vec3 column_part_of(BoxBlocks blocks, int part) {
    return part == 0 ? blocks.first : part == 1 ? blocks.middle : blocks.last;
}

// Texels of a box' part: first, and one past the last.
GPU_FN ivec2 part_range(AxisBox box, int part) {
    return part == 0   ? ivec2(box.first, box.first + 1)
           : part == 1 ? ivec2(box.first + 1, box.last)
                       : ivec2(box.last, box.last + 1);
}

GPU_FN int part_holding(AxisBox box, int i) {
    return i == box.first ? 0 : i == box.last ? 2 : 1;
}

GPU_FN Pair corner_of(EdgeCorners edge, int k) {
    return k == 0 ? edge.a : k == 1 ? edge.b : k == 2 ? edge.c : edge.d;
}

// Corners of the table below and above a run of rows, at one edge along x.
struct RunEdge {
    Pair bottom, top;
};

GPU_FN RunEdge run_edge(AreaTable table, int i, ivec2 rows) {
    RunEdge edge;
    edge.bottom = corner(table, i, rows.x);
    edge.top = corner(table, i, rows.y);
    return edge;
}

GPU_FN RunEdge run_edge_of(EdgeCorners edge, int row_part) {
    RunEdge run;
    run.bottom = corner_of(edge, row_part);
    run.top = corner_of(edge, row_part + 1);
    return run;
}

GPU_FN Pair run_sum(RunEdge edge) {
    return pair_difference(edge.top, edge.bottom);
}

// The edges of a box' block.
struct BlockEdges {
    RunEdge left, right;
};

GPU_FN BlockEdges block_edges(BoxCorners box, int column_part, int row_part) {
    BlockEdges edges;
    if (column_part == 0) {
        edges.left = run_edge_of(box.a, row_part);
        edges.right = run_edge_of(box.b, row_part);
    } else if (column_part == 1) {
        edges.left = run_edge_of(box.b, row_part);
        edges.right = run_edge_of(box.c, row_part);
    } else {
        edges.left = run_edge_of(box.c, row_part);
        edges.right = run_edge_of(box.d, row_part);
    }
    return edges;
}

// A texel, and a place in the part of it that the box holds, in [0, 1)^2. texel.x < 0: none.
struct BoxPick {
    ivec2 texel;
    vec2 fraction;
    int steps;  // of both searches, two corners each
};

// The texel of a block where the light of all columns before it passes a fraction of the block's,
// and within that column that of all rows. By bisection over whole texels to the end.
GPU_FN BoxPick
pick_in_block(AreaTable table, BlockEdges edges, ivec2 columns, ivec2 rows, vec2 coordinates) {
    BoxPick pick;
    pick.steps = 0;
    Pair before = run_sum(edges.left);
    float below = 0.0f, above = float_difference(run_sum(edges.right), before);
    float target = coordinates.x * above;
    int lo = columns.x, hi = columns.y;
    do {
        int middle = (lo + hi) / 2;
        RunEdge edge = run_edge(table, middle, rows);
        float light = float_difference(run_sum(edge), before);
        bool is_left = target < light;
        hi = is_left ? middle : hi;
        above = is_left ? light : above;
        lo = is_left ? lo : middle;
        below = is_left ? below : light;
        if (is_left)
            edges.right = edge;
        else
            edges.left = edge;
        pick.steps += 1;
    } while (hi - lo > 1);
    pick.texel.x = lo;
    pick.fraction.x = fraction_of(target - below, above - below);
    before = pair_difference(edges.right.bottom, edges.left.bottom);
    below = 0.0f;
    above = float_difference(pair_difference(edges.right.top, edges.left.top), before);
    target = coordinates.y * above;
    pick.texel.x = above > 0.0f ? pick.texel.x : -1;  // dark: found by rounding alone
    int bottom = rows.x, top = rows.y;
    do {
        int middle = (bottom + top) / 2;
        float light = float_difference(
            pair_difference(corner(table, lo + 1, middle), corner(table, lo, middle)), before);
        bool is_below = target < light;
        top = is_below ? middle : top;
        above = is_below ? light : above;
        bottom = is_below ? bottom : middle;
        below = is_below ? below : light;
        pick.steps += 1;
    } while (top - bottom > 1);
    pick.texel.y = bottom;
    pick.fraction.y = fraction_of(target - below, above - below);
    return pick;
}

// The place where the joint distribution of a box takes the values `coordinates`, both in [0, 1):
// the first chooses the first column, those between or the last, by all their rows; the second the
// first row, those between or the last of these; what is left of both the place in that block.
GPU_FN BoxPick pick_in_box(
    AreaTable table, BoxCorners corners, BoxBlocks blocks, AxisBox x, AxisBox y, vec2 coordinates) {
    vec3 columns = column_energies(blocks);
    PartPick column = pick_part(columns, coordinates.x * sum_of(columns));
    vec3 rows = column_part_of(blocks, column.part);
    PartPick row = pick_part(rows, coordinates.y * sum_of(rows));
    vec2 rest = vec2(fraction_of(column.target, part_of(columns, column.part)),
                     fraction_of(row.target, part_of(rows, row.part)));
    return pick_in_block(table, block_edges(corners, column.part, row.part),
                         part_range(x, column.part), part_range(y, row.part), rest);
}

// The inverse: the coordinates at which pick_in_box gives a place.
GPU_FN vec2
invert_in_box(AreaTable table, BoxBlocks blocks, AxisBox x, AxisBox y, ivec2 texel, vec2 fraction) {
    int column_part = part_holding(x, texel.x), row_part = part_holding(y, texel.y);
    ivec2 columns = part_range(x, column_part), rows = part_range(y, row_part);
    vec3 of_columns = column_energies(blocks);
    vec3 of_rows = column_part_of(blocks, column_part);
    Pair before = run_sum(run_edge(table, columns.x, rows));
    float left = float_difference(run_sum(run_edge(table, texel.x, rows)), before);
    float right = float_difference(run_sum(run_edge(table, texel.x + 1, rows)), before);
    float block = float_difference(run_sum(run_edge(table, columns.y, rows)), before);
    Pair first =
        pair_difference(corner(table, texel.x + 1, rows.x), corner(table, texel.x, rows.x));
    float below = float_difference(
        pair_difference(corner(table, texel.x + 1, texel.y), corner(table, texel.x, texel.y)),
        first);
    float above = float_difference(pair_difference(corner(table, texel.x + 1, texel.y + 1),
                                                   corner(table, texel.x, texel.y + 1)),
                                   first);
    float column = right - left;
    float rest_x = fraction_of(left + fraction.x * column, block);
    float rest_y = fraction_of(below + fraction.y * (above - below), column);
    float parts_left = column_part == 0   ? 0.0f
                       : column_part == 1 ? of_columns.x
                                          : of_columns.x + of_columns.y;
    float parts_below = row_part == 0 ? 0.0f : row_part == 1 ? of_rows.x : of_rows.x + of_rows.y;
    return vec2(
        fraction_of(parts_left + rest_x * part_of(of_columns, column_part), sum_of(of_columns)),
        fraction_of(parts_below + rest_y * part_of(of_rows, row_part), sum_of(of_rows)));
}

// The coordinate e of a place in texel i's part of a box.
GPU_FN float e_in_box(AxisView view, AxisTexels s, AxisBox box, int i, float fraction) {
    Interval part = texel_part(view, s, box.e_lo, box.e_hi, i);
    return part.lo + fraction * (part.hi - part.lo);
}

SHARED_END

#endif
