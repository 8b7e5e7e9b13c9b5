// SPDX-License-Identifier: Apache-2.0
#include "formats/model/prepared.h"

#include "formats/model/axis_window.h"
#include "formats/model/profile.h"
#include "formats/model/row_sums.h"
#include "formats/model/window_sum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace nearfield::model {
namespace {

using shared::AxisView;
using shared::CellMoments;

// Widest window, in tangents, over which one node at a texel's centroid stands for 1 / (1 + t^2)^2:
// relative error h^2 / 12 f'' / 2 < 1e-4. Wider texels go by double precision's pieces.
constexpr float kWidestCentroidTexel = 0.015F;

// The windows of all basis functions along one axis, in float. Weights are padded by kRowPadding
// zeros.
struct FloatWindow {
    TexelRange range;
    float t_lo = 0.0F, t_hi = 0.0F;
    std::size_t at = 0;  // offset of its weights in m0 and m1
};
struct FloatWindows {
    std::vector<FloatWindow> of_basis;
    std::vector<float> m0, m1;
    float widest_texel_t = 0.0F;
};

// Adds a run of texels' moments against one cell. Copies in, separate rows out: the compiler
// vectorizes it.
void add_cell(SlabAxis<float> axis,
              AxisView view,
              TexelRange range,
              float u_lo,
              const std::array<double, 3>& cell,
              float center,
              float* m0,
              float* m1) {
    const auto a0 = static_cast<float>(cell[0]), a1 = static_cast<float>(cell[1]),
               a2 = static_cast<float>(cell[2]);
    const float inv_pitch = 1.0F / axis.pitch;
    const float cell_lo = e_of_u(view, u_lo), cell_hi = e_of_u(view, u_lo + axis.pitch);
#pragma omp simd
    for (int k = 0; k < range.count; ++k) {
        const float e_a = e_of_s(view, axis.texel_edge(range.first + k));
        const float e_b = e_of_s(view, axis.texel_edge(range.first + k + 1));
        const float e_lo = e_a < e_b ? e_a : e_b, e_hi = e_a < e_b ? e_b : e_a;
        const float above = e_lo > cell_lo ? e_lo : cell_lo;
        const float lo = above < cell_hi ? above : cell_hi;
        const float below = e_hi < cell_hi ? e_hi : cell_hi;
        const float hi = below > lo ? below : lo;
        const CellMoments m = cell_moments(view, lo, hi, a0, a1, a2, center, inv_pitch);
        m0[k] += m.m0;
        m1[k] += m.m1;
    }
}

void fill(FloatWindows& windows, const Slab& slab, int axis_index, float p, float height) {
    const SlabAxis<float> axis(slab, axis_index);
    const AxisView view = shared::axis_view(p, axis.delta, height);
    const float half_support = 0.5F * static_cast<float>(axis.cells) * axis.pitch;
    windows.of_basis.resize(static_cast<std::size_t>(axis.grid));
    windows.m0.clear();
    windows.m1.clear();
    for (int k = 0; k < axis.grid; ++k) {
        const auto center = static_cast<float>(slab.basis_center_m(k, k)[axis_index]);
        const float u_lo = center - half_support, u_hi = center + half_support;
        FloatWindow& window = windows.of_basis[static_cast<std::size_t>(k)];
        const float s_a = shared::s_of_u(u_lo, p, axis.delta, height);
        const float s_b = shared::s_of_u(u_hi, p, axis.delta, height);
        window.range = texel_range(axis, s_a, s_b);
        window.at = windows.m0.size();
        windows.m0.resize(window.at + static_cast<std::size_t>(window.range.count) + kRowPadding,
                          0.0F);
        windows.m1.resize(windows.m0.size(), 0.0F);
        for (int c = 0; c < axis.cells; ++c) {
            const float cell_lo = u_lo + static_cast<float>(c) * axis.pitch;
            const TexelRange seen =
                texel_range(axis, shared::s_of_u(cell_lo, p, axis.delta, height),
                            shared::s_of_u(cell_lo + axis.pitch, p, axis.delta, height));
            const TexelRange range = intersection(seen, window.range);
            const std::size_t at =
                window.at + static_cast<std::size_t>(range.first - window.range.first);
            add_cell(axis, view, range, cell_lo, slab.profile.cells[static_cast<std::size_t>(c)],
                     center, windows.m0.data() + at, windows.m1.data() + at);
        }

        // Tangents of the support, cut where its texels end.
        const float e_a = e_of_s(view, axis.texel_edge(window.range.first));
        const float e_b = e_of_s(view, axis.texel_edge(window.range.first + window.range.count));
        const float e_lo = std::max(e_of_u(view, u_lo), std::min(e_a, e_b));
        const float e_hi = std::min(e_of_u(view, u_hi), std::max(e_a, e_b));
        window.t_lo = t_of_e(view, std::min(e_lo, e_hi));
        window.t_hi = t_of_e(view, std::max(e_lo, e_hi));
    }
    const float texel_e =
        std::abs(e_of_s(view, axis.s_min + axis.texel) - e_of_s(view, axis.s_min));
    windows.widest_texel_t =
        std::min(texel_e * view.t_scale, 2.0F * half_support / (axis.delta + height));
}

// What one receiver sees; p and q are the weights along x that depend on its normal.
struct View {
    glm::vec3 normal{0.0F};
    FloatWindows x, y;
    std::vector<float> p, q;
    bool by_pieces = false;
};

// Kept from call to call: no allocation a receiver.
std::vector<View>& views_of_thread(std::size_t count) {
    thread_local std::vector<View> views;
    if (views.size() < count)
        views.resize(count);
    return views;
}

bool plane_cuts(const FloatWindows& x, const FloatWindows& y, glm::vec3 n) {
    // Rounding of the windows' ends must not hide a cut: what is nearly cut is treated as cut.
    constexpr float kMargin = 1e-5F;
    float x_lo = 0.0F, x_hi = 0.0F, y_lo = 0.0F, y_hi = 0.0F;
    const auto bounds = [](const FloatWindows& windows, float& lo, float& hi) {
        bool any = false;
        for (const FloatWindow& window : windows.of_basis) {
            if (window.range.count == 0)
                continue;
            lo = any ? std::min(lo, window.t_lo) : window.t_lo;
            hi = any ? std::max(hi, window.t_hi) : window.t_hi;
            any = true;
        }
    };
    bounds(x, x_lo, x_hi);
    bounds(y, y_lo, y_hi);
    const float least = std::min(n.x * x_lo, n.x * x_hi) + std::min(n.y * y_lo, n.y * y_hi) - n.z;
    const float scale =
        1.0F + std::max(std::abs(x_lo), std::abs(x_hi)) + std::max(std::abs(y_lo), std::abs(y_hi));
    return !(least > kMargin * scale);
}

float luminance(glm::vec3 rgb) {
    return static_cast<float>(kLuminanceRgb[0]) * rgb.r +
           static_cast<float>(kLuminanceRgb[1]) * rgb.g +
           static_cast<float>(kLuminanceRgb[2]) * rgb.b;
}

// Receivers whose plane cuts a window, and kernels that vary over a texel: double precision, piece
// by piece.
glm::vec3 irradiance_by_pieces(const PreparedSlab& prepared,
                               const ReceiverF& receiver,
                               std::span<float> image_y) {
    const Slab& slab = prepared.slab;
    const auto p = glm::dvec3(receiver.position_m), n = glm::dvec3(receiver.normal);
    const AxisWindows x = make_windows(slab, 0, p.x, p.z);
    const AxisWindows y = make_windows(slab, 1, p.y, p.z);
    const double scale =
        slab.weighting == Weighting::Irradiance ? slab.delta_m * slab.delta_m : 1.0;
    glm::dvec3 total(0.0);
    for (int m = 0; m < slab.image_count(); ++m) {
        glm::dvec3 sums(0.0);
        add_image(slab, prepared.coeffs.data() + slab.image_offset(0, m), slab.image_offset(1, 0),
                  x.of_basis[static_cast<std::size_t>(m % slab.grid.x)],
                  y.of_basis[static_cast<std::size_t>(m / slab.grid.x)], n, &sums.x);
        if (slab.channels == 1)
            sums = glm::dvec3(sums.x);
        sums = glm::max(sums, 0.0) * scale;
        total += sums;
        if (!image_y.empty())
            image_y[static_cast<std::size_t>(m)] = luminance(glm::vec3(sums));
    }
    return glm::vec3(total);
}

// A window's lit part: its texels, and where their weights start.
struct LitPart {
    TexelRange x, y;
    std::size_t x_at, y_at;
};

LitPart lit_part(const FloatWindow& x, const FloatWindow& y, glm::ivec4 lit) {
    LitPart part;
    part.x = intersection(x.range, {lit[0], lit[2] - lit[0]});
    part.y = intersection(y.range, {lit[1], lit[3] - lit[1]});
    part.x_at = x.at + static_cast<std::size_t>(part.x.first - x.range.first);
    part.y_at = y.at + static_cast<std::size_t>(part.y.first - y.range.first);
    return part;
}

const float* first_texel(const PreparedSlab& prepared, int channel, int m, const LitPart& part) {
    return prepared.coeffs.data() + prepared.slab.image_offset(channel, m) +
           static_cast<std::size_t>(part.y.first) *
               static_cast<std::size_t>(prepared.slab.texels.x) +
           static_cast<std::size_t>(part.x.first);
}

// Sum of one image and channel with irradiance weighting: p = n_x X1 - n_z X0, q = n_y X0.
float image_sum(
    const PreparedSlab& prepared, int channel, int m, const LitPart& part, const View& view) {
    return row_sums(first_texel(prepared, channel, m, part),
                    static_cast<std::size_t>(prepared.slab.texels.x),
                    static_cast<std::size_t>(part.y.count), static_cast<std::size_t>(part.x.count),
                    view.p.data() + part.x_at, view.q.data() + part.x_at,
                    view.y.m0.data() + part.y_at, view.y.m1.data() + part.y_at);
}

// Sum of one image and channel with radiance weighting: the kernel at every texel's centroid.
float image_sum_radiance(
    const PreparedSlab& prepared, int channel, int m, const LitPart& part, const View& view) {
    const auto stride = static_cast<std::size_t>(prepared.slab.texels.x);
    const float* image = first_texel(prepared, channel, m, part);
    const float *x0 = view.x.m0.data() + part.x_at, *tx = view.p.data() + part.x_at;
    const glm::vec3 n = view.normal;
    float sum = 0.0F;
    for (int j = 0; j < part.y.count; ++j) {
        const float y0 = view.y.m0[part.y_at + static_cast<std::size_t>(j)];
        if (!(y0 > 0.0F))
            continue;
        const float ty = view.y.m1[part.y_at + static_cast<std::size_t>(j)] / y0;
        const float cosine_y = n.y * ty - n.z, r2_y = 1.0F + ty * ty;
        const float* row = image + static_cast<std::size_t>(j) * stride;
        float line = 0.0F;
#pragma omp simd reduction(+ : line)
        for (int i = 0; i < part.x.count; ++i) {
            const float r2 = r2_y + tx[i] * tx[i];
            line += row[i] * x0[i] * (n.x * tx[i] + cosine_y) / (r2 * r2);
        }
        sum += y0 * line;
    }
    return sum;
}

// The weights along x that depend on the normal (irradiance weighting: p and q; radiance: centroids
// in p).
void weigh_x(View& s, bool radiance_weighting) {
    const glm::vec3 n = s.normal;
    s.p.resize(s.x.m0.size());
    s.q.resize(s.x.m0.size());
    for (std::size_t i = 0; i < s.x.m0.size(); ++i) {
        if (radiance_weighting)
            s.p[i] = s.x.m0[i] > 0.0F ? s.x.m1[i] / s.x.m0[i] : 0.0F;
        else
            s.p[i] = n.x * s.x.m1[i] - n.z * s.x.m0[i];
        s.q[i] = n.y * s.x.m0[i];
    }
}

// Fills a view's windows and weights, or marks it for double precision. Behind U: windows without
// texels.
void look(const PreparedSlab& prepared, const ReceiverF& receiver, View& view) {
    const Slab& slab = prepared.slab;
    const glm::vec3 p = receiver.position_m;
    const bool radiance_weighting = slab.weighting == Weighting::Radiance;
    view.normal = receiver.normal;
    view.by_pieces = false;
    if (!(p.z > -static_cast<float>(slab.delta_m))) {
        view.x.of_basis.assign(static_cast<std::size_t>(slab.grid.x), {});
        view.y.of_basis.assign(static_cast<std::size_t>(slab.grid.y), {});
        return;
    }
    fill(view.x, slab, 0, p.x, p.z);
    fill(view.y, slab, 1, p.y, p.z);
    const bool kernel_varies =
        radiance_weighting &&
        std::max(view.x.widest_texel_t, view.y.widest_texel_t) > kWidestCentroidTexel;
    view.by_pieces = kernel_varies || plane_cuts(view.x, view.y, view.normal);
    if (!view.by_pieces)
        weigh_x(view, radiance_weighting);
}

glm::ivec4 lit_texels(const PreparedSlab& prepared, int m) {
    const Slab& slab = prepared.slab;
    glm::ivec4 lit(slab.texels, 0, 0);
    for (int c = 0; c < slab.channels; ++c) {
        const float* texel = prepared.coeffs.data() + slab.image_offset(c, m);
        for (int j = 0; j < slab.texels.y; ++j)
            for (int i = 0; i < slab.texels.x; ++i)
                if (*texel++ > 0.0F)
                    lit = {std::min(lit[0], i), std::min(lit[1], j), std::max(lit[2], i + 1),
                           std::max(lit[3], j + 1)};
    }
    return lit[2] > lit[0] ? lit : glm::ivec4(0);
}

}  // namespace

PreparedSlab prepare(Slab slab) {
    PreparedSlab prepared;
    prepared.coeffs = std::move(slab.coeffs);
    prepared.coeffs.resize(prepared.coeffs.size() + kRowPadding * 4, 0.0F);
    slab.coeffs = {};
    const double whole = integral(slab.profile);
    for (std::size_t c = 0; c < slab.profile.cells.size(); ++c)
        prepared.cell_share.push_back(static_cast<float>(integral(slab.profile, c) / whole));
    prepared.slab = std::move(slab);
    for (int m = 0; m < prepared.slab.image_count(); ++m)
        prepared.lit.push_back(lit_texels(prepared, m));
    return prepared;
}

void irradiance(const PreparedSlab& prepared,
                std::span<const ReceiverF> receivers,
                std::span<glm::vec3> results,
                std::span<float> image_y) {
    const Slab& slab = prepared.slab;
    const auto images = static_cast<std::size_t>(slab.image_count());
    const bool radiance_weighting = slab.weighting == Weighting::Radiance;
    std::fill(image_y.begin(), image_y.end(), 0.0F);
    std::vector<View>& views = views_of_thread(receivers.size());
    for (std::size_t k = 0; k < receivers.size(); ++k) {
        const std::span<float> shares =
            image_y.empty() ? image_y : image_y.subspan(k * images, images);
        look(prepared, receivers[k], views[k]);
        results[k] = views[k].by_pieces ? irradiance_by_pieces(prepared, receivers[k], shares)
                                        : glm::vec3(0.0F);
    }

    // Images outside, receivers inside: neighbors read the same window while it is in the
    // first-level cache.
    const float scale = radiance_weighting ? 1.0F : static_cast<float>(slab.delta_m * slab.delta_m);
    for (std::size_t m = 0; m < images; ++m)
        for (std::size_t k = 0; k < receivers.size(); ++k) {
            const View& view = views[k];
            if (view.by_pieces)
                continue;
            const FloatWindow& x = view.x.of_basis[m % static_cast<std::size_t>(slab.grid.x)];
            const FloatWindow& y = view.y.of_basis[m / static_cast<std::size_t>(slab.grid.x)];
            const LitPart part = lit_part(x, y, prepared.lit[m]);
            if (part.x.count == 0 || part.y.count == 0)
                continue;
            glm::vec3 sums(0.0F);
            for (int c = 0; c < slab.channels; ++c) {
                const auto image = static_cast<int>(m);
                const float sum = radiance_weighting
                                      ? image_sum_radiance(prepared, c, image, part, view)
                                      : image_sum(prepared, c, image, part, view);
                sums[c] = std::max(sum, 0.0F) * scale;
            }
            if (slab.channels == 1)
                sums = glm::vec3(sums.x);
            results[k] += sums;
            if (!image_y.empty())
                image_y[k * images + m] = luminance(sums);
        }
}

glm::vec3 irradiance(const PreparedSlab& prepared,
                     const ReceiverF& receiver,
                     std::span<float> image_y) {
    glm::vec3 result(0.0F);
    irradiance(prepared, {&receiver, 1}, {&result, 1}, image_y);
    return result;
}

}  // namespace nearfield::model
