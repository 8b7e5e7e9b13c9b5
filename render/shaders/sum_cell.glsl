// SPDX-License-Identifier: Apache-2.0
// The windowed sum through one column of U's cells. For sum.comp, which says what Light is.

// Texel columns whose weights are kept, and the iterations of inner loops that a dispatch may take a
// pixel, counted in `work`, before it leaves what remains to the next: no dispatch may run long, and
// llvmpipe ends all loops of eight pixels after 65535 iterations together. The eight of them diverge
// where pieces are counted, hardly elsewhere.
#ifdef BY_PIECES
const int kBlock = 1;
const int kMostWork = 4096;
#else
const int kQuads = 2;
const int kBlock = 4 * kQuads;
const int kMostWork = 16384;
#endif
int work = 0;

// Basis column k as its cell cell_x is seen.
struct CellColumn {
    int k, cell_x;
    AxisBox box;
    CellPhi phi;
};

CellColumn cell_column(SumView view, int k, int cell_x) {
    CellColumn column;
    column.k = k;
    column.cell_x = cell_x;
    column.box = box_of_cell_x(view, k + cell_x);
    column.phi = cell_phi(0, k, cell_x);
    return column;
}

float centroid_t(CellMoments m, AxisBox box, float scale) {
    float reach = 0.5 * (box.e_hi - box.e_lo) * scale;  // where rounding is larger than phi
    return m.m0 > 0.0 ? clamp(m.m1 / m.m0, -reach, reach) : 0.0;
}

// A texel's weights, 0 beyond the column. Irradiance weighting: n_x int (t - t_c) phi and int phi;
// radiance weighting: the centroid's t - t_c and int phi.
vec2 texel_weights(SumView view, CellColumn column, int i) {
    CellMoments m = texel_moments(view.x, view.s_x, column.box, column.phi, i);
#ifdef IS_RADIANCE
    return vec2(centroid_t(m, column.box, view.scale), m.m0);
#else
    return vec2(view.normal.x * m.m1, m.m0);
#endif
}

// A cell of U as it is seen, and the cosine in its middle (t_c).
struct SeenCell {
    AxisBox y;
    CellPhi phi_y;
    float cosine, t_x, t_y;
};

#ifdef BY_PIECES

struct BlockWeights {
    vec2 of_texel;
};
BlockWeights block_weights(SumView view, CellColumn column, int first) {
    BlockWeights weights;
    weights.of_texel = texel_weights(view, column, first);
    return weights;
}

// One row of texels, in front of the receiver. Irradiance weighting alone.
Light row_by_moments(SumView view, SeenCell cell, BlockWeights weights, int image, int first, int j) {
    CellMoments m = texel_moments(view.y, view.s_y, cell.y, cell.phi_y, j);
    return texel_light(image, first, j) *
           dot(weights.of_texel, vec2(m.m0, cell.cosine * m.m0 + view.normal.y * m.m1));
}

#else

struct BlockWeights {
    vec4 a[kQuads], b[kQuads];
};
BlockWeights block_weights(SumView view, CellColumn column, int first) {
    BlockWeights weights;
    for (int q = 0; q < kQuads; ++q) {
        vec2 w0 = texel_weights(view, column, first + 4 * q);
        vec2 w1 = texel_weights(view, column, first + 4 * q + 1);
        vec2 w2 = texel_weights(view, column, first + 4 * q + 2);
        vec2 w3 = texel_weights(view, column, first + 4 * q + 3);
        weights.a[q] = vec4(w0.x, w1.x, w2.x, w3.x);
        weights.b[q] = vec4(w0.y, w1.y, w2.y, w3.y);
    }
    return weights;
}

Light row_by_moments(SumView view, SeenCell cell, BlockWeights weights, int image, int first, int j) {
    CellMoments m = texel_moments(view.y, view.s_y, cell.y, cell.phi_y, j);
#ifdef IS_RADIANCE
    float t_y = centroid_t(m, cell.y, view.scale);
    float cosine_y = cell.cosine + view.normal.y * t_y;
    float r2_y = 1.0 + (cell.t_y + t_y) * (cell.t_y + t_y);
    Light sum = Light(0.0);
    for (int q = 0; q < kQuads; ++q) {
        vec4 t_x = cell.t_x + weights.a[q];
        vec4 r2 = r2_y + t_x * t_x;
        vec4 weight = weights.b[q] * (view.normal.x * weights.a[q] + cosine_y) / (r2 * r2);
        sum += quad_dot(quad_at(image, first / 4 + q, j), weight);
    }
    return m.m0 * sum;
#else
    Light along_x = Light(0.0), flat_part = Light(0.0);
    for (int q = 0; q < kQuads; ++q) {
        Quad quad = quad_at(image, first / 4 + q, j);
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
        sum += pair_weight(view, part_of(x, q % parts_x, parts_x), column.phi,
                           part_of(y, q / parts_x, parts_y), cell.phi_y);
        ++work;
    }
    ++work;
    return sum;
#else
    return pair_weight(view, x, column.phi, y, cell.phi_y);
#endif
}
#endif

// One image's light through one cell and a block of columns.
Light image_block(SumView view, CellColumn column, BlockWeights weights, SeenCell cell,
                  bool by_pieces, int image, int first) {
    ivec4 lit = slab_lit[image];
    int last = min(column.box.last, lit.z - 1);
    int j_first = max(cell.y.first, lit.y);
    int j_last = first > last || first + kBlock <= lit.x ? -1 : min(cell.y.last, lit.w - 1);
    Light sum = Light(0.0);
    for (int j = j_first; j <= (by_pieces ? -1 : j_last); ++j, ++work)
        sum += row_by_moments(view, cell, weights, image, first, j);
#ifdef BY_PIECES
    for (int j = j_first; j <= (by_pieces ? j_last : -1); ++j, ++work)
        sum += texel_light(image, first, j) * texel_weight(view, column, cell, first, j);
#endif
    work += 3;
    return sum;
}

// All images of the column's basis functions through a block of texel columns.
Light sum_of_block(SumView view, CellColumn column, int first) {
    BlockWeights weights = block_weights(view, column, first);
    int rows = slab.grid_texels.y;
    Light sum = Light(0.0);
    for (int row = 0; row < cells_along(1); ++row) {
        SeenCell cell;
        cell.y = box_of_cell_y(view, row);
        cell.cosine = cosine_in_middle(view, column.box, cell.y);
        float reach = cosine_reach(view, column.box, cell.y);
        if (is_empty(cell.y) || cell.cosine + reach <= 0.0)
            continue;
        cell.t_x = t_of_e(view.x, 0.5 * (column.box.e_lo + column.box.e_hi));
        cell.t_y = t_of_e(view.y, 0.5 * (cell.y.e_lo + cell.y.e_hi));
#if !defined(BY_PIECES)
        const bool by_pieces = false;
#elif defined(IS_RADIANCE)
        const bool by_pieces = true;  // the kernel may matter where the cosine is small
#else
        bool by_pieces = cell.cosine < reach;
#endif
        for (int cell_y = max(0, row - rows + 1); cell_y <= min(cell_count() - 1, row); ++cell_y) {
            float seen = visibility(column.k, row - cell_y, column.cell_x, cell_y);
            if (!(seen > 0.0))
                continue;
            cell.phi_y = cell_phi(1, row - cell_y, cell_y);
            int image = (row - cell_y) * slab.grid_texels.x + column.k;
            sum += seen * image_block(view, column, weights, cell, by_pieces, image, first);
        }
    }
    return sum;
}
