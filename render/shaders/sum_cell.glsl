// SPDX-License-Identifier: Apache-2.0
// The windowed sum through one column of U's cells. For sum.comp, which says what Light is.

// Texel columns whose weights are kept, and the iterations of inner loops that a dispatch may take a
// pixel, counted in `work`, before it leaves what remains to the next: no dispatch may run long, and
// llvmpipe ends all loops of eight pixels after 65535 iterations together. The eight of them diverge
// where pieces are counted, hardly elsewhere.
#ifdef BY_PIECES
const int kBlock = 1, kAlign = 1;
const int kMostWork = 4096;
#else
#ifndef QUADS
#define QUADS 8
#endif
const int kQuads = QUADS;
const int kBlock = 4 * kQuads, kAlign = 4;
const int kMostWork = 16384;
#endif
int work = 0;

// Basis column k as its cells cell_x ... cell_x + cells - 1 are seen: all, or by pieces one.
struct CellColumn {
    int k, cell_x, cells;
    AxisBox box;
};

CellColumn cell_column(SumView view, int k, int cell_x, int cells) {
    CellColumn column;
    column.k = k;
    column.cell_x = cell_x;
    column.cells = cells;
    column.box = axis_box(view.x, view.s_x, cell_edges_m(0, k + cell_x).x,
                          cell_edges_m(0, k + cell_x + cells - 1).y);
    return column;
}

// Within `reach` of the box's middle: where rounding is larger than int phi the quotient may be
// anything.
float centroid_t(float m1, float m0, float reach) {
    return m0 > 0.0 ? clamp(m1 / m0, -reach, reach) : 0.0;
}

// One of a column's cells, in e.
Interval cell_of_column(SumView view, CellColumn column, int cell) {
    vec2 edges_m = cell_edges_m(0, column.k + cell);
    Interval part;
    part.lo = max(e_of_u(view.x, edges_m.x), column.box.e_lo);
    part.hi = min(e_of_u(view.x, edges_m.y), column.box.e_hi);
    return part;
}

// A cell of U as it is seen, and the cosine in its middle (t_c).
struct SeenCell {
    AxisBox y;
    CellPhi phi_y;
    float cosine, t_x, t_y;
};

CellMoments row_moments(SumView view, SeenCell cell, int j) {
    Interval part;
    part.lo = cell.y.e_lo;
    part.hi = cell.y.e_hi;
    return texel_moments(view.y, view.s_y, part, 0.5 * (part.lo + part.hi), cell.phi_y, j);
}

#ifdef BY_PIECES

// A texel's weights, 0 beyond the column: n_x int (t - t_c) phi and int phi.
struct BlockWeights {
    vec2 of_texel;
};
BlockWeights block_weights(SumView view, CellColumn column, int first) {
    float e_c = 0.5 * (column.box.e_lo + column.box.e_hi);
    CellMoments m = texel_moments(view.x, view.s_x, cell_of_column(view, column, column.cell_x), e_c,
                                  cell_phi(0, column.k, column.cell_x), first);
    BlockWeights weights;
    weights.of_texel = vec2(view.normal.x * m.m1, m.m0);
    return weights;
}

// One row of texels, in front of the receiver. Irradiance weighting alone.
Light row_by_moments(SumView view, SeenCell cell, BlockWeights weights, int image, int first, int j) {
    CellMoments m = row_moments(view, cell, j);
    return texel_light(image, first, j) *
           dot(weights.of_texel, vec2(m.m0, cell.cosine * m.m0 + view.normal.y * m.m1));
}

#else

// Moments of a block's texels, 0 beyond the column: of each of its cells where these are seen each
// by its own visibility, else of all together. Tangents count from the column's middle.
#ifdef CELLS_APART
#ifndef CELLS
#define CELLS 3
#endif
const int kSets = CELLS;
#else
const int kSets = 1;
#endif
struct BlockMoments {
    vec4 m0[kQuads * kSets], m1[kQuads * kSets];
};

BlockMoments block_moments(SumView view, CellColumn column, int first) {
    BlockMoments moments;
    float e_c = 0.5 * (column.box.e_lo + column.box.e_hi);
    for (int at = 0; at < kQuads * kSets; ++at)
        moments.m0[at] = moments.m1[at] = vec4(0.0);
    for (int set = 0; set < kSets; ++set) {
        int cell = set;
        do {
            Interval part = cell_of_column(view, column, cell);
            CellPhi phi = cell_phi(0, column.k, cell);
            for (int q = 0; q < kQuads; ++q)
                for (int i = 0; i < 4; ++i) {
                    CellMoments m =
                        texel_moments(view.x, view.s_x, part, e_c, phi, first + 4 * q + i);
                    moments.m0[set * kQuads + q][i] += m.m0;
                    moments.m1[set * kQuads + q][i] += m.m1;
                }
#ifdef CELLS_APART
        } while (false);
#else
        } while (++cell < cell_count());
#endif
    }
    return moments;
}

// Texels' weights before what one row of cells shows of them. Irradiance weighting: n_x int (t - t_c)
// phi and int phi; radiance weighting: the centroid's t - t_c and int phi.
struct BlockWeights {
    vec4 a[kQuads], b[kQuads];
};
BlockWeights block_weights(SumView view, CellColumn column, BlockMoments moments, int row) {
    BlockWeights weights;
    for (int q = 0; q < kQuads; ++q)
        weights.a[q] = weights.b[q] = vec4(0.0);
    for (int set = 0; set < kSets; ++set) {
#ifdef CELLS_APART
        float seen = visibility_of_cell(column.k + set, row);
#else
        const float seen = 1.0;
#endif
        for (int q = 0; q < kQuads; ++q) {
            weights.a[q] += seen * moments.m1[set * kQuads + q];
            weights.b[q] += seen * moments.m0[set * kQuads + q];
        }
    }
#ifdef IS_RADIANCE
    float reach = 0.5 * (column.box.e_hi - column.box.e_lo) * view.scale;
    for (int q = 0; q < kQuads; ++q)
        for (int i = 0; i < 4; ++i)
            weights.a[q][i] = centroid_t(weights.a[q][i], weights.b[q][i], reach);
#else
    for (int q = 0; q < kQuads; ++q)
        weights.a[q] *= view.normal.x;
#endif
    return weights;
}

Light row_by_moments(SumView view, SeenCell cell, BlockWeights weights, int image, int first, int j) {
    CellMoments m = row_moments(view, cell, j);
#ifdef IS_RADIANCE
    float t_y = centroid_t(m.m1, m.m0, 0.5 * (cell.y.e_hi - cell.y.e_lo) * view.scale);
    int place = place_of_quad(image, first / 4, j);
    float cosine_y = cell.cosine + view.normal.y * t_y;
    float r2_y = 1.0 + (cell.t_y + t_y) * (cell.t_y + t_y);
    Light sum = Light(0.0);
    for (int q = 0; q < kQuads; ++q) {
        vec4 t_x = cell.t_x + weights.a[q];
        vec4 r2 = r2_y + t_x * t_x;
        vec4 weight = weights.b[q] * (view.normal.x * weights.a[q] + cosine_y) / (r2 * r2);
        sum += quad_dot(quad_at(place + q), weight);
    }
    return m.m0 * sum;
#else
    int place = place_of_quad(image, first / 4, j);
    Light along_x = Light(0.0), flat_part = Light(0.0);
    for (int q = 0; q < kQuads; ++q) {
        Quad quad = quad_at(place + q);
        along_x += quad_dot(quad, weights.a[q]);
        flat_part += quad_dot(quad, weights.b[q]);
    }
    return m.m0 * along_x + (cell.cosine * m.m0 + view.normal.y * m.m1) * flat_part;
#endif
}

#endif

#ifdef BY_PIECES
// Parts along an axis of a texel, for the kernel: enough from 1e-3 delta above U.
const int kMostParts = 64;

// Part q of `parts` equal ones.
Interval part_of(Interval whole, int q, int parts) {
    float width = (whole.hi - whole.lo) / float(parts);
    Interval part;
    part.lo = whole.lo + float(q) * width;
    part.hi = q + 1 == parts ? whole.hi : whole.lo + float(q + 1) * width;
    return part;
}

float pair_weight(SumView view, Interval part_x, CellPhi phi_x, Interval part_y, CellPhi phi_y) {
    float middle = (view.normal.x * 0.5 * (part_x.lo + part_x.hi) +
                    view.normal.y * 0.5 * (part_y.lo + part_y.hi) + view.plane) * view.scale;
    PhiPiece x = texel_piece(view.x, part_x, phi_x), y = texel_piece(view.y, part_y, phi_y);
    return integrate_pair(x, y, pair_cosine(x, y, view.normal, middle), has_radiance_weighting());
}

float texel_weight(SumView view, CellColumn column, SeenCell cell, int i, int j) {
    Interval x = texel_part(view.x, view.s_x, column.box.e_lo, column.box.e_hi, i);
    Interval y = texel_part(view.y, view.s_y, cell.y.e_lo, cell.y.e_hi, j);
    if (!(x.lo < x.hi && y.lo < y.hi))
        return 0.0;
#ifdef IS_RADIANCE
    int parts_x = min(kernel_pieces((x.hi - x.lo) * view.scale), kMostParts);
    int parts_y = min(kernel_pieces((y.hi - y.lo) * view.scale), kMostParts);
    float sum = 0.0;
    for (int q = 0; q < parts_x * parts_y; ++q) {
        sum += pair_weight(view, part_of(x, q % parts_x, parts_x), cell_phi(0, column.k, column.cell_x),
                           part_of(y, q / parts_x, parts_y), cell.phi_y);
        ++work;
    }
    ++work;
    return sum;
#else
    return pair_weight(view, x, cell_phi(0, column.k, column.cell_x), y, cell.phi_y);
#endif
}
#endif

// One image's light through one cell and a block of columns. Loops that ask at their end: where a
// loop asks first, llvmpipe runs its body once more for all eight pixels. What they run once too
// often weighs nothing.
Light image_block(SumView view, CellColumn column, BlockWeights weights, SeenCell cell,
                  bool by_pieces, int image, int first) {
    ivec4 lit = lit_of(image);
    int last = min(column.box.last, lit.z - 1);
    int j = max(cell.y.first, lit.y);
    int j_last = first > last || first + kBlock <= lit.x ? -1 : min(cell.y.last, lit.w - 1);
    Light sum = Light(0.0);
#ifdef BY_PIECES
    for (; j <= j_last; ++j, ++work)
        if (by_pieces)
            sum += texel_light(image, first, j) * texel_weight(view, column, cell, first, j);
        else
            sum += row_by_moments(view, cell, weights, image, first, j);
#else
    do {
        sum += row_by_moments(view, cell, weights, image, first, j);
        ++work;
    } while (++j <= j_last);
#endif
    work += 3;
    return sum;
}

SeenCell seen_cell(SumView view, CellColumn column, int row) {
    SeenCell cell;
    cell.y = box_of_cell_y(view, row);
    cell.cosine = cosine_in_middle(view, column.box, cell.y);
    cell.t_x = t_of_e(view.x, 0.5 * (column.box.e_lo + column.box.e_hi));
    cell.t_y = t_of_e(view.y, 0.5 * (cell.y.e_lo + cell.y.e_hi));
    return cell;
}

// All images of the column's basis functions through a block of texel columns.
Light sum_of_block(SumView view, CellColumn column, int first) {
#ifdef BY_PIECES
    BlockWeights weights = block_weights(view, column, first);
#else
    BlockMoments moments = block_moments(view, column, first);
#endif
    int rows = slab.grid_texels.y;
    Light sum = Light(0.0);
    int row = 0;
    do {
        SeenCell cell = seen_cell(view, column, row);
        float reach = cosine_reach(view, column.box, cell.y);
        if (is_empty(cell.y) || cell.cosine + reach <= 0.0 || !is_any_seen(column.k, row))
            continue;
#if !defined(BY_PIECES)
        const bool by_pieces = false;
        BlockWeights weights = block_weights(view, column, moments, row);
#elif defined(IS_RADIANCE)
        const bool by_pieces = true;  // the kernel may matter where the cosine is small
#else
        bool by_pieces = cell.cosine < reach;
#endif
        int cell_y = max(0, row - rows + 1);
        do {
            float seen = visibility(column.k, row - cell_y, column.cell_x, cell_y);
            if (!(seen > 0.0))
                continue;
            cell.phi_y = cell_phi(1, row - cell_y, cell_y);
            int image = (row - cell_y) * slab.grid_texels.x + column.k;
            sum += seen * image_block(view, column, weights, cell, by_pieces, image, first);
        } while (++cell_y <= min(cell_count() - 1, row));
    } while (++row < cells_along(1));
    return sum;
}
