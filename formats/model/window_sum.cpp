// SPDX-License-Identifier: Apache-2.0
#include "formats/model/window_sum.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::model {
namespace {

using shared::f64::CellMoments;

// Gauss-Legendre nodes and weights on [-1, 1].
constexpr std::array<double, 3> kNodes3 = {-0.7745966692414834, 0.0, 0.7745966692414834};
constexpr std::array<double, 3> kWeights3 = {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
constexpr std::array<double, 4> kNodes4 = {-0.8611363115940526, -0.3399810435848563,
                                           0.3399810435848563, 0.8611363115940526};
constexpr std::array<double, 4> kWeights4 = {0.3478548451374538, 0.6521451548625461,
                                             0.6521451548625461, 0.3478548451374538};

// Widest piece, in tangents, over which 3 Gauss nodes integrate 1 / (1 + t^2)^2 to 1e-7: the next
// term of the rule is h^7 f'''''' / 2,016,000 with f'''''' below 5,000.
constexpr double kWidestKernelPiece = 0.2;

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
            const int parts = split_for_kernel
                                  ? std::max(1, static_cast<int>(std::ceil(std::min(
                                                    (t_hi - t_lo) / kWidestKernelPiece, 1000.0))))
                                  : 1;
            for (int q = 0; q < parts; ++q)
                window.pieces.push_back(
                    {i, lo + (hi - lo) * q / parts, lo + (hi - lo) * (q + 1) / parts, a0, a1, a2});
        }
    }
}

double phi(const AxisWindow& window, const Piece& piece, double e) {
    const double x = (u_of_e(window.view, e) - window.center_m) * window.inv_pitch;
    return piece.a0 + x * (piece.a1 + x * piece.a2);
}

// The integrand of a piece pair at tangents (t_x, t_y).
struct Integrand {
    glm::dvec3 normal;
    bool radiance_weighting;

    double cosine(double t_x, double t_y) const {
        return normal.x * t_x + normal.y * t_y - normal.z;
    }
    double operator()(double t_x, double t_y) const {
        const double r2 = 1.0 + t_x * t_x + t_y * t_y;
        return cosine(t_x, t_y) / (radiance_weighting ? r2 * r2 : 1.0);
    }
};

// int int phi_a phi_b f over b in [lo_b(e_a), hi_b(e_a)], where the boundary is linear in e_a: 4 x
// 3 Gauss nodes, exact for irradiance weighting (degree 7 and 5 suffice: 6 and 3 occur).
template <typename LowerEdge, typename UpperEdge>
double integrate_strip(const AxisWindow& a,
                       const Piece& piece_a,
                       const AxisWindow& b,
                       const Piece& piece_b,
                       double a_lo,
                       double a_hi,
                       const LowerEdge& lo_b,
                       const UpperEdge& hi_b,
                       const Integrand& f,
                       bool a_is_x) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kNodes4.size(); ++i) {
        const double e_a = 0.5 * (a_lo + a_hi) + 0.5 * (a_hi - a_lo) * kNodes4[i];
        const double lo = lo_b(e_a), hi = hi_b(e_a);
        if (!(hi > lo))
            continue;
        double inner = 0.0;
        for (std::size_t j = 0; j < kNodes3.size(); ++j) {
            const double e_b = 0.5 * (lo + hi) + 0.5 * (hi - lo) * kNodes3[j];
            const double t_a = t_of_e(a.view, e_a), t_b = t_of_e(b.view, e_b);
            inner += kWeights3[j] * phi(b, piece_b, e_b) * (a_is_x ? f(t_a, t_b) : f(t_b, t_a));
        }
        sum += kWeights4[i] * phi(a, piece_a, e_a) * inner * 0.5 * (hi - lo);
    }
    return sum * 0.5 * (a_hi - a_lo) * a.view.t_scale * b.view.t_scale;
}

// A piece pair that the receiver's plane cuts. The line n.(t, -1) = 0 bounds b as a linear function
// of a, where b is the axis with the larger normal component; a is split where the line enters and
// leaves the rectangle.
double integrate_cut(const AxisWindow& x,
                     const Piece& piece_x,
                     const AxisWindow& y,
                     const Piece& piece_y,
                     const Integrand& f) {
    const bool a_is_x = std::abs(f.normal.y) >= std::abs(f.normal.x);
    const AxisWindow& a = a_is_x ? x : y;
    const AxisWindow& b = a_is_x ? y : x;
    const Piece& piece_a = a_is_x ? piece_x : piece_y;
    const Piece& piece_b = a_is_x ? piece_y : piece_x;
    const double n_a = a_is_x ? f.normal.x : f.normal.y;
    const double n_b = a_is_x ? f.normal.y : f.normal.x;
    if (n_b == 0.0)
        return 0.0;

    // e_b on the line, as a function of e_a; e and t are proportional with positive scale.
    const auto line = [&](double e_a) {
        const double t_b = (f.normal.z - n_a * t_of_e(a.view, e_a)) / n_b;
        return t_b / b.view.t_scale + b.view.t_origin;
    };
    const auto crossing = [&](double e_b) {
        const double t_a = (f.normal.z - n_b * t_of_e(b.view, e_b)) / n_a;
        return t_a / a.view.t_scale + a.view.t_origin;
    };
    std::array<double, 4> edges = {piece_a.e_lo, piece_a.e_hi, piece_a.e_hi, piece_a.e_hi};
    if (n_a != 0.0) {
        edges[1] = std::clamp(crossing(piece_b.e_lo), piece_a.e_lo, piece_a.e_hi);
        edges[2] = std::clamp(crossing(piece_b.e_hi), piece_a.e_lo, piece_a.e_hi);
        std::sort(edges.begin(), edges.end());
    }
    const auto lower = [&](double e_a) {
        return n_b > 0.0 ? std::clamp(line(e_a), piece_b.e_lo, piece_b.e_hi) : piece_b.e_lo;
    };
    const auto upper = [&](double e_a) {
        return n_b > 0.0 ? piece_b.e_hi : std::clamp(line(e_a), piece_b.e_lo, piece_b.e_hi);
    };
    double sum = 0.0;
    for (std::size_t k = 0; k + 1 < edges.size(); ++k)
        if (edges[k + 1] > edges[k])
            sum += integrate_strip(a, piece_a, b, piece_b, edges[k], edges[k + 1], lower, upper, f,
                                   a_is_x);
    return std::max(sum, 0.0);
}

// A piece pair wholly in front of the receiver.
double integrate_whole(const AxisWindow& x,
                       const Piece& piece_x,
                       const AxisWindow& y,
                       const Piece& piece_y,
                       const Integrand& f) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kNodes3.size(); ++i) {
        const double e_x =
            0.5 * (piece_x.e_lo + piece_x.e_hi) + 0.5 * (piece_x.e_hi - piece_x.e_lo) * kNodes3[i];
        double inner = 0.0;
        for (std::size_t j = 0; j < kNodes3.size(); ++j) {
            const double e_y = 0.5 * (piece_y.e_lo + piece_y.e_hi) +
                               0.5 * (piece_y.e_hi - piece_y.e_lo) * kNodes3[j];
            inner +=
                kWeights3[j] * phi(y, piece_y, e_y) * f(t_of_e(x.view, e_x), t_of_e(y.view, e_y));
        }
        sum += kWeights3[i] * phi(x, piece_x, e_x) * inner;
    }
    return sum * 0.25 * (piece_x.e_hi - piece_x.e_lo) * (piece_y.e_hi - piece_y.e_lo) *
           x.view.t_scale * y.view.t_scale;
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
                   const Integrand& f,
                   double* sums) {
    const auto width = static_cast<std::size_t>(slab.texels.x);
    for (const Piece& piece_y : y.pieces) {
        const float* row = coeffs + static_cast<std::size_t>(piece_y.texel) * width;
        const double y_lo = t_of_e(y.view, piece_y.e_lo), y_hi = t_of_e(y.view, piece_y.e_hi);
        for (const Piece& piece_x : x.pieces) {
            const float* texel = row + piece_x.texel;
            bool dark = true;
            for (int c = 0; c < slab.channels; ++c)
                dark = dark && texel[static_cast<std::size_t>(c) * channel_stride] == 0.0F;
            if (dark)
                continue;
            const CosineRange cosine = cosine_range(
                t_of_e(x.view, piece_x.e_lo), t_of_e(x.view, piece_x.e_hi), y_lo, y_hi, f.normal);
            if (cosine.largest <= 0.0)
                continue;
            const double weight = cosine.least >= 0.0 ? integrate_whole(x, piece_x, y, piece_y, f)
                                                      : integrate_cut(x, piece_x, y, piece_y, f);
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
    const Integrand f{normal, slab.weighting == Weighting::Radiance};
    if (f.radiance_weighting || cosine.least < 0.0)
        add_by_pieces(slab, coeffs, channel_stride, x, y, f, sums);
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
    return m00 * std::max(Integrand{n, slab.weighting == Weighting::Radiance}(t_x, t_y), 0.0);
}

}  // namespace nearfield::model
