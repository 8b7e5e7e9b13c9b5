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

// int C_m over the columns between two edges, each of y's texels by its width in t. Never below 0,
// which rounding could give for a dark box in a bright image.
GPU_FN float columns_energy(EdgeCorners left, EdgeCorners right, AxisBox y) {
    Pair a = pair_difference(right.a, left.a);
    Pair b = pair_difference(right.b, left.b);
    Pair c = pair_difference(right.c, left.c);
    Pair d = pair_difference(right.d, left.d);
    return max(y.first_width * float_difference(b, a) + y.texel_width * float_difference(c, b) +
                   y.last_width * float_difference(d, c),
               0.0f);
}

// The energy of a box in three parts along an axis: of its first texels, those between and the
// last.
struct BoxParts {
    float first, middle, last;
};

GPU_FN float parts_sum(BoxParts parts) {
    return parts.first + parts.middle + parts.last;
}

// A box' columns in three parts, int C_m dt_x dt_y per m^2 of texels' area. Cost: 16 corners.
GPU_FN BoxParts column_parts(AreaTable table, AxisBox x, AxisBox y) {
    EdgeCorners a = edge_corners(table, y, x.first);
    EdgeCorners b = edge_corners(table, y, x.first + 1);
    EdgeCorners c = edge_corners(table, y, max(x.last, x.first + 1));
    EdgeCorners d = edge_corners(table, y, x.last + 1);
    BoxParts parts;
    parts.first = x.first_width * columns_energy(a, b, y);
    parts.middle = x.texel_width * columns_energy(b, c, y);
    parts.last = x.last_width * columns_energy(c, d, y);
    return parts;
}

// Corners at one edge along y, of a single column's difference.
GPU_FN Pair column_corner(AreaTable table, int column, int j) {
    return pair_difference(corner(table, column + 1, j), corner(table, column, j));
}

// One column's rows in three parts. Cost: 8 corners.
GPU_FN BoxParts row_parts(AreaTable table, int column, AxisBox y) {
    Pair a = column_corner(table, column, y.first);
    Pair b = column_corner(table, column, y.first + 1);
    Pair c = column_corner(table, column, max(y.last, y.first + 1));
    Pair d = column_corner(table, column, y.last + 1);
    BoxParts parts;
    parts.first = y.first_width * max(float_difference(b, a), 0.0f);
    parts.middle = y.texel_width * max(float_difference(c, b), 0.0f);
    parts.last = y.last_width * max(float_difference(d, c), 0.0f);
    return parts;
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

GPU_FN PartPick pick_part(BoxParts parts, float target) {
    PartPick pick;
    pick.part = 0;
    pick.target = target;
    float energy = parts.first;
    if (target >= parts.first && parts.middle + parts.last > 0.0f) {
        float beyond = target - parts.first;
        bool is_last = parts.last > 0.0f && beyond >= parts.middle;
        pick.part = is_last ? 2 : parts.middle > 0.0f ? 1 : 2;
        pick.target = pick.part == 2 ? beyond - parts.middle : beyond;
        energy = pick.part == 2 ? parts.last : parts.middle;
    }
    pick.target = clamp(pick.target, 0.0f, energy * 0.99999994f);
    return pick;
}

GPU_FN float fraction_of(float part, float whole) {
    return whole > 0.0f ? clamp(part / whole, 0.0f, 0.99999994f) : 0.5f;
}

// The column where the energy of all columns before it passes the target in [0, sum of parts), by
// bisection over whole columns: its number of steps is fixed by theirs.
GPU_FN TexelPick pick_column(AreaTable table, AxisBox x, AxisBox y, BoxParts parts, float target) {
    PartPick part = pick_part(parts, target);
    TexelPick pick;
    pick.steps = 0;
    if (part.part != 1) {
        pick.texel = part.part == 0 ? x.first : x.last;
        pick.fraction = fraction_of(part.target, part.part == 0 ? parts.first : parts.last);
        return pick;
    }
    EdgeCorners left = edge_corners(table, y, x.first + 1);
    int lo = x.first + 1, hi = x.last;
    float below = 0.0f, above = parts.middle;
    while (hi - lo > 1) {
        int middle = (lo + hi) / 2;
        float energy = x.texel_width * columns_energy(left, edge_corners(table, y, middle), y);
        bool is_left = part.target < energy;
        hi = is_left ? middle : hi;
        above = is_left ? energy : above;
        lo = is_left ? lo : middle;
        below = is_left ? below : energy;
        pick.steps += 1;
    }
    pick.texel = lo;
    pick.fraction = fraction_of(part.target - below, above - below);
    return pick;
}

// The same along y within one column.
GPU_FN TexelPick pick_row(AreaTable table, int column, AxisBox y, BoxParts parts, float target) {
    PartPick part = pick_part(parts, target);
    TexelPick pick;
    pick.steps = 0;
    if (part.part != 1) {
        pick.texel = part.part == 0 ? y.first : y.last;
        pick.fraction = fraction_of(part.target, part.part == 0 ? parts.first : parts.last);
        return pick;
    }
    Pair bottom = column_corner(table, column, y.first + 1);
    int lo = y.first + 1, hi = y.last;
    float below = 0.0f, above = parts.middle;
    while (hi - lo > 1) {
        int middle = (lo + hi) / 2;
        float energy = y.texel_width *
                       max(float_difference(column_corner(table, column, middle), bottom), 0.0f);
        bool is_below = part.target < energy;
        hi = is_below ? middle : hi;
        above = is_below ? energy : above;
        lo = is_below ? lo : middle;
        below = is_below ? below : energy;
        pick.steps += 1;
    }
    pick.texel = lo;
    pick.fraction = fraction_of(part.target - below, above - below);
    return pick;
}

// The inverse: energy of the box' columns before column i, first <= i <= last + 1, as pick_column
// sees it.
GPU_FN float energy_left_of(AreaTable table, AxisBox x, AxisBox y, BoxParts parts, int i) {
    if (i <= x.first) {
        return 0.0f;
    }
    if (i > x.last) {
        return parts_sum(parts);
    }
    return parts.first + x.texel_width * columns_energy(edge_corners(table, y, x.first + 1),
                                                        edge_corners(table, y, i), y);
}

GPU_FN float energy_below(AreaTable table, int column, AxisBox y, BoxParts parts, int j) {
    if (j <= y.first) {
        return 0.0f;
    }
    if (j > y.last) {
        return parts_sum(parts);
    }
    Pair middle = column_corner(table, column, j);
    Pair bottom = column_corner(table, column, y.first + 1);
    return parts.first + y.texel_width * max(float_difference(middle, bottom), 0.0f);
}

SHARED_END

#endif
