// SPDX-License-Identifier: Apache-2.0
#include "formats/model/window_sum.h"

#include <algorithm>

namespace nearfield::model {
namespace {

using shared::f64::CellMoments;
using shared::f64::PairCosine;

// Splits the window's texels at the cells' edges; appends pieces and sums the moments by texel.
void fill(AxisWindow& window,
          const SlabAxis<double>& axis,
          const Profile& profile,
          bool split_for_kernel) {
    const double n = static_cast<double>(axis.cells);
    window.m0.assign(static_cast<std::size_t>(window.range.count), 0.0);
    window.m1.assign(static_cast<std::size_t>(window.range.count), 0.0);
    bool any = false;
    for (int c = 0; c < axis.cells; ++c) {
        const auto& [a0, a1, a2] = profile.cells[static_cast<std::size_t>(c)];
        const double u_lo = window.center_m + (c - 0.5 * n) * axis.pitch;
        const double cell_lo = e_of_u(window.view, u_lo);
        const double cell_hi = e_of_u(window.view, u_lo + axis.pitch);
        for (int k = 0; k < window.range.count; ++k) {
            const int i = window.range.first + k;
            const double e_a = e_of_s(window.view, axis.texel_edge(i));
            const double e_b = e_of_s(window.view, axis.texel_edge(i + 1));
            const double lo = std::max(std::min(e_a, e_b), cell_lo);
            const double hi = std::min(std::max(e_a, e_b), cell_hi);
            if (!(hi > lo))
                continue;
            const CellMoments m =
                cell_moments(window.view, lo, hi, a0, a1, a2, window.center_m, window.inv_pitch);
            window.m0[static_cast<std::size_t>(k)] += m.m0;
            window.m1[static_cast<std::size_t>(k)] += m.m1;

            const double t_lo = t_of_e(window.view, lo), t_hi = t_of_e(window.view, hi);
            window.t_lo = any ? std::min(window.t_lo, t_lo) : t_lo;
            window.t_hi = any ? std::max(window.t_hi, t_hi) : t_hi;
            any = true;
            const int parts = split_for_kernel ? shared::f64::kernel_pieces(t_hi - t_lo) : 1;
            for (int q = 0; q < parts; ++q)
                window.pieces.push_back({i, phi_piece(window.view, lo + (hi - lo) * q / parts,
                                                      lo + (hi - lo) * (q + 1) / parts, a0, a1, a2,
                                                      window.center_m, window.inv_pitch)});
        }
    }
}

CosineRange cosine_range(double x_lo, double x_hi, double y_lo, double y_hi, glm::dvec3 normal) {
    const double x_a = normal.x * x_lo, x_b = normal.x * x_hi;
    const double y_a = normal.y * y_lo, y_b = normal.y * y_hi;
    return {std::min(x_a, x_b) + std::min(y_a, y_b) - normal.z,
            std::max(x_a, x_b) + std::max(y_a, y_b) - normal.z};
}

// By pieces: where the plane cuts the window, or the kernel varies over it.
void add_by_pieces(const Slab& slab,
                   const float* coeffs,
                   std::size_t channel_stride,
                   const AxisWindow& x,
                   const AxisWindow& y,
                   glm::dvec3 n,
                   double* sums) {
    const auto width = static_cast<std::size_t>(slab.texels.x);
    const bool is_radiance = slab.weighting == Weighting::Radiance;
    for (const Piece& piece_y : y.pieces) {
        const float* row = coeffs + static_cast<std::size_t>(piece_y.texel) * width;
        for (const Piece& piece_x : x.pieces) {
            const float* texel = row + piece_x.texel;
            bool dark = true;
            for (int c = 0; c < slab.channels; ++c)
                dark = dark && texel[static_cast<std::size_t>(c) * channel_stride] == 0.0F;
            if (dark)
                continue;
            const double at_middle = n.x * piece_x.phi.t_middle + n.y * piece_y.phi.t_middle - n.z;
            const PairCosine cosine = pair_cosine(piece_x.phi, piece_y.phi, n, at_middle);
            const double weight = integrate_pair(piece_x.phi, piece_y.phi, cosine, is_radiance);
            for (int c = 0; c < slab.channels; ++c)
                sums[c] += weight *
                           static_cast<double>(texel[static_cast<std::size_t>(c) * channel_stride]);
        }
    }
}

// By texels: moments are products of one axis' each.
void add_by_moments(const Slab& slab,
                    const float* coeffs,
                    std::size_t channel_stride,
                    const AxisWindow& x,
                    const AxisWindow& y,
                    glm::dvec3 n,
                    double* sums) {
    const auto width = static_cast<std::size_t>(slab.texels.x);
    const auto count = static_cast<std::size_t>(x.range.count);
    for (int c = 0; c < slab.channels; ++c) {
        const float* image = coeffs + static_cast<std::size_t>(c) * channel_stride;
        double sum = 0.0;
        for (int k = 0; k < y.range.count; ++k) {
            const float* row =
                image + static_cast<std::size_t>(y.range.first + k) * width + x.range.first;
            double row_m0 = 0.0, row_m1 = 0.0;
            for (std::size_t i = 0; i < count; ++i) {
                row_m0 += static_cast<double>(row[i]) * x.m0[i];
                row_m1 += static_cast<double>(row[i]) * x.m1[i];
            }
            const double y_m0 = y.m0[static_cast<std::size_t>(k)];
            const double y_m1 = y.m1[static_cast<std::size_t>(k)];
            sum += n.x * row_m1 * y_m0 + row_m0 * (n.y * y_m1 - n.z * y_m0);
        }
        sums[c] += sum;
    }
}

AxisWindows make(const Slab& slab,
                 int axis_index,
                 const AxisViewD& view,
                 bool far,
                 double p_m,
                 double height_m) {
    const SlabAxis<double> axis(slab, axis_index);
    const double half_support = 0.5 * axis.cells * axis.pitch;
    AxisWindows windows;
    windows.of_basis.resize(static_cast<std::size_t>(axis.grid));
    for (int k = 0; k < axis.grid; ++k) {
        AxisWindow& window = windows.of_basis[static_cast<std::size_t>(k)];
        window.view = view;
        window.center_m = slab.basis_center_m(k, k)[axis_index];
        window.inv_pitch = 1.0 / axis.pitch;
        const double u_lo = window.center_m - half_support, u_hi = window.center_m + half_support;
        const auto s_of = [&](double u) {
            return far ? u - view.s_shift : shared::f64::s_of_u(u, p_m, axis.delta, height_m);
        };
        window.range = texel_range(axis, s_of(u_lo), s_of(u_hi));
        fill(window, axis, slab.profile, slab.weighting == Weighting::Radiance && !far);
    }
    return windows;
}

}  // namespace

AxisWindows make_windows(const Slab& slab, int axis, double p_m, double height_m) {
    return make(slab, axis, shared::f64::axis_view(p_m, slab.delta_m, height_m), false, p_m,
                height_m);
}

AxisWindows make_far_windows(const Slab& slab, int axis, double tangent) {
    return make(slab, axis, shared::f64::axis_view_far(tangent, slab.delta_m), true, 0.0, 0.0);
}

CosineRange cosine_range(const AxisWindow& x, const AxisWindow& y, glm::dvec3 normal) {
    return cosine_range(x.t_lo, x.t_hi, y.t_lo, y.t_hi, normal);
}

void add_image(const Slab& slab,
               const float* coeffs,
               std::size_t channel_stride,
               const AxisWindow& x,
               const AxisWindow& y,
               glm::dvec3 normal,
               double* sums) {
    if (x.pieces.empty() || y.pieces.empty())
        return;
    const CosineRange cosine = cosine_range(x, y, normal);
    if (cosine.largest <= 0.0)
        return;
    if (slab.weighting == Weighting::Radiance || cosine.least < 0.0)
        add_by_pieces(slab, coeffs, channel_stride, x, y, normal, sums);
    else
        add_by_moments(slab, coeffs, channel_stride, x, y, normal, sums);
}

double texel_weight(
    const Slab& slab, const AxisWindow& x, const AxisWindow& y, glm::dvec3 n, int i, int j) {
    const auto kx = static_cast<std::size_t>(i - x.range.first);
    const auto ky = static_cast<std::size_t>(j - y.range.first);
    const double m00 = x.m0[kx] * y.m0[ky];
    if (m00 <= 0.0)
        return 0.0;
    const double t_x = x.m1[kx] / x.m0[kx], t_y = y.m1[ky] / y.m0[ky];
    const double r2 = slab.weighting == Weighting::Radiance ? 1.0 + t_x * t_x + t_y * t_y : 1.0;
    return m00 * std::max((n.x * t_x + n.y * t_y - n.z) / (r2 * r2), 0.0);
}

}  // namespace nearfield::model
