// SPDX-License-Identifier: Apache-2.0
#include "formats/model/float_windows.h"

#include "formats/model/row_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nearfield::model {
namespace {

using shared::AxisView;
using shared::CellMoments;

constexpr int kLanes = 8;  // texels that are weighed at once

int round_up(int count) {
    return (count + kLanes - 1) / kLanes * kLanes;
}

// The cells of U (W + n - 1 of them), each seen through a run of texels.
void find_cells(FloatWindows& windows,
                const SlabAxis<float>& axis,
                const AxisView& view,
                float u_first,
                float height) {
    const int count = axis.grid + axis.cells - 1;
    windows.cell_edge_e.resize(static_cast<std::size_t>(count) + 1);
    windows.cell_range.resize(static_cast<std::size_t>(count));
    float s_before = 0.0F;
    for (int c = 0; c <= count; ++c) {
        const float u = u_first + static_cast<float>(c) * axis.pitch;
        const float s = shared::s_of_u(u, view.p, axis.delta, height);
        windows.cell_edge_e[static_cast<std::size_t>(c)] = e_of_u(view, u);
        if (c > 0)
            windows.cell_range[static_cast<std::size_t>(c) - 1] = texel_range(axis, s_before, s);
        s_before = s;
    }
}

TexelRange hull(TexelRange a, TexelRange b) {
    if (a.count == 0)
        return b;
    if (b.count == 0)
        return a;
    const int first = std::min(a.first, b.first);
    return {first, std::max(a.first + a.count, b.first + b.count) - first};
}

// Both ends in e of all texels in range, and of what a block of lanes reads beyond it. Texels
// beyond S lie at infinity, where no cell is.
void find_texels(FloatWindows& windows,
                 const SlabAxis<float>& axis,
                 const AxisView& view,
                 TexelRange range) {
    const auto count = static_cast<std::size_t>(range.count + kLanes);
    windows.texel_lo.resize(count);
    windows.texel_hi.resize(count);
    float* lo = windows.texel_lo.data();
    float* hi = windows.texel_hi.data();
    const int real_count = std::min(static_cast<int>(count), axis.texels - range.first);
    const SlabAxis<float> edges = axis;
    const AxisView view_copy = view;
#pragma omp simd
    for (int k = 0; k < real_count; ++k) {
        const float e_a = e_of_s(view_copy, edges.texel_edge(range.first + k));
        const float e_b = e_of_s(view_copy, edges.texel_edge(range.first + k + 1));
        lo[k] = e_a < e_b ? e_a : e_b;
        hi[k] = e_a < e_b ? e_b : e_a;
    }
    std::fill(lo + real_count, lo + count, std::numeric_limits<float>::infinity());
    std::fill(hi + real_count, hi + count, std::numeric_limits<float>::infinity());
}

// Adds the moments of kLanes texels, whose ends are texel_lo and texel_hi, against one cell of one
// basis function. Texels that do not meet the cell add zero. Straight code on copies: the compiler
// vectorizes it.
void add_block(AxisView view,
               const float* texel_lo,
               const float* texel_hi,
               float cell_lo,
               float cell_hi,
               std::array<float, 3> cell,
               float center,
               float inv_pitch,
               float* m0,
               float* m1) {
#pragma omp simd
    for (int k = 0; k < kLanes; ++k) {
        const float above = texel_lo[k] > cell_lo ? texel_lo[k] : cell_lo;
        const float lo = above < cell_hi ? above : cell_hi;
        const float below = texel_hi[k] < cell_hi ? texel_hi[k] : cell_hi;
        const float hi = below > lo ? below : lo;
        const CellMoments m =
            cell_moments(view, lo, hi, cell[0], cell[1], cell[2], center, inv_pitch);
        m0[k] += m.m0;
        m1[k] += m.m1;
    }
}

// The weights of basis function k, centered at `center`.
void weigh(FloatWindows& windows,
           const Slab& slab,
           const SlabAxis<float>& axis,
           const AxisView& view,
           int k,
           float center,
           int first_texel) {
    FloatWindow& window = windows.of_basis[static_cast<std::size_t>(k)];
    for (int c = 0; c < axis.cells; ++c) {
        const auto at_cell = static_cast<std::size_t>(k + c);
        const TexelRange range = windows.cell_range[at_cell];
        const auto& [a0, a1, a2] = slab.profile.cells[static_cast<std::size_t>(c)];
        for (int block = 0; block < range.count; block += kLanes) {
            const auto texel = static_cast<std::size_t>(range.first + block - first_texel);
            const std::size_t at =
                window.at + static_cast<std::size_t>(range.first + block - window.range.first);
            add_block(view, windows.texel_lo.data() + texel, windows.texel_hi.data() + texel,
                      windows.cell_edge_e[at_cell], windows.cell_edge_e[at_cell + 1],
                      {static_cast<float>(a0), static_cast<float>(a1), static_cast<float>(a2)},
                      center, 1.0F / axis.pitch, windows.m0.data() + at, windows.m1.data() + at);
        }
    }
}

}  // namespace

void fill(FloatWindows& windows, const Slab& slab, int axis_index, float p_m, float height_m) {
    const SlabAxis<float> axis(slab, axis_index);
    const AxisView view = shared::axis_view(p_m, axis.delta, height_m);
    const auto first_center = static_cast<float>(slab.basis_center_m(0, 0)[axis_index]);
    const float half_support = 0.5F * static_cast<float>(axis.cells) * axis.pitch;
    find_cells(windows, axis, view, first_center - half_support, height_m);

    windows.of_basis.resize(static_cast<std::size_t>(axis.grid));
    TexelRange all;
    std::size_t weights = 0;
    for (std::size_t k = 0; k < windows.of_basis.size(); ++k) {
        FloatWindow& window = windows.of_basis[k];
        window.range = {};
        for (std::size_t c = 0; c < slab.profile.cells.size(); ++c)
            window.range = hull(window.range, windows.cell_range[k + c]);
        window.at = weights;
        weights += static_cast<std::size_t>(round_up(window.range.count)) + kRowPadding;
        all = hull(all, window.range);
    }
    windows.m0.assign(weights, 0.0F);
    windows.m1.assign(weights, 0.0F);
    find_texels(windows, axis, view, all);

    for (int k = 0; k < axis.grid; ++k) {
        FloatWindow& window = windows.of_basis[static_cast<std::size_t>(k)];
        if (window.range.count == 0)
            continue;
        weigh(windows, slab, axis, view, k, first_center + static_cast<float>(k) * axis.pitch,
              all.first);

        // Tangents of the support, cut where its texels end.
        const auto first = static_cast<std::size_t>(window.range.first - all.first);
        const std::size_t last = first + static_cast<std::size_t>(window.range.count) - 1;
        const float texels_lo = std::min(windows.texel_lo[first], windows.texel_lo[last]);
        const float texels_hi = std::max(windows.texel_hi[first], windows.texel_hi[last]);
        const auto k_size = static_cast<std::size_t>(k);
        const float e_lo = std::max(windows.cell_edge_e[k_size], texels_lo);
        const float e_hi =
            std::min(windows.cell_edge_e[k_size + slab.profile.cells.size()], texels_hi);
        window.t_lo = t_of_e(view, std::min(e_lo, e_hi));
        window.t_hi = t_of_e(view, std::max(e_lo, e_hi));
    }
    const float texel_e =
        std::abs(e_of_s(view, axis.s_min + axis.texel) - e_of_s(view, axis.s_min));
    windows.widest_texel_t =
        std::min(texel_e * view.t_scale, 2.0F * half_support / (axis.delta + height_m));
}

}  // namespace nearfield::model
