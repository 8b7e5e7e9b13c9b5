// SPDX-License-Identifier: Apache-2.0
#include "formats/model/prepared.h"

#include "formats/model/axis_window.h"
#include "formats/model/float_windows.h"
#include "formats/model/profile.h"
#include "formats/model/row_sums.h"
#include "formats/model/window_sum.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::model {
namespace {

// Widest window, in tangents, over which one node at a texel's centroid stands for 1 / (1 + t^2)^2:
// relative error h^2 / 12 f'' / 2 < 1e-4. Wider texels go by double precision's pieces.
constexpr float kWidestCentroidTexel = 0.015F;

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
        add_image(slab, slab.coeffs.data() + slab.image_offset(0, m), slab.image_offset(1, 0),
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
    const Slab& slab = prepared.slab;
    const bool is_last = channel + 1 == slab.channels && m + 1 == slab.image_count();
    const float* image =
        is_last ? prepared.last_image.data() : slab.coeffs.data() + slab.image_offset(channel, m);
    return image +
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

// From the borders inwards, so that a bright image costs next to nothing.
glm::ivec4 lit_texels(const Slab& slab, int m) {
    const int w = slab.texels.x, h = slab.texels.y;
    const auto is_lit = [&](int i, int j) {
        bool lit = false;
        for (int c = 0; c < slab.channels; ++c)
            lit = lit || slab.coeffs[slab.image_offset(c, m) +
                                     static_cast<std::size_t>(j) * static_cast<std::size_t>(w) +
                                     static_cast<std::size_t>(i)] > 0.0F;
        return lit;
    };
    const auto row_is_lit = [&](int j) {
        for (int i = 0; i < w; ++i)
            if (is_lit(i, j))
                return true;
        return false;
    };
    int bottom = 0, top = h;
    while (bottom < h && !row_is_lit(bottom))
        ++bottom;
    while (top > bottom && !row_is_lit(top - 1))
        --top;
    int left = w, right = 0;
    for (int j = bottom; j < top; ++j) {
        for (int i = 0; i < left; ++i)
            if (is_lit(i, j))
                left = i;
        for (int i = w; i > right; --i)
            if (is_lit(i - 1, j))
                right = i;
    }
    return right > left ? glm::ivec4(left, bottom, right, top) : glm::ivec4(0);
}

}  // namespace

PreparedSlab prepare(Slab slab) {
    PreparedSlab prepared;
    const double whole = integral(slab.profile);
    for (std::size_t c = 0; c < slab.profile.cells.size(); ++c)
        prepared.cell_share.push_back(static_cast<float>(integral(slab.profile, c) / whole));
    prepared.lit.resize(static_cast<std::size_t>(slab.image_count()));
    tbb::parallel_for(std::size_t{0}, prepared.lit.size(), [&](std::size_t m) {
        prepared.lit[m] = lit_texels(slab, static_cast<int>(m));
    });
    prepared.last_image.assign(slab.coeffs.end() - static_cast<std::ptrdiff_t>(slab.texel_count()),
                               slab.coeffs.end());
    prepared.last_image.resize(slab.texel_count() + kRowPadding, 0.0F);
    prepared.slab = std::move(slab);
    return prepared;
}

std::uint64_t irradiance(const PreparedSlab& prepared,
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
    std::uint64_t multiply_adds = 0;
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
            multiply_adds += 2 * static_cast<std::uint64_t>(slab.channels) *
                             static_cast<std::uint64_t>(part.x.count) *
                             static_cast<std::uint64_t>(part.y.count);
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
    return multiply_adds;
}

glm::vec3 irradiance(const PreparedSlab& prepared,
                     const ReceiverF& receiver,
                     std::span<float> image_y) {
    glm::vec3 result(0.0F);
    irradiance(prepared, {&receiver, 1}, {&result, 1}, image_y);
    return result;
}

}  // namespace nearfield::model
