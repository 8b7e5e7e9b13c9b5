// SPDX-License-Identifier: Apache-2.0
#include "formats/model/prepared.h"

#include "formats/model/axis_window.h"
#include "formats/model/float_windows.h"
#include "formats/model/profile.h"
#include "formats/model/row_sums.h"
#include "formats/model/window_sum.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace nearfield::model {
namespace {

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

// How the receiver's plane lies to everything that its windows see.
enum class Facing { Towards, Cut, Away };

// Least and largest tangent of all windows along one axis.
glm::vec2 bounds(const FloatWindows& windows) {
    glm::vec2 range(std::numeric_limits<float>::infinity(),
                    -std::numeric_limits<float>::infinity());
    for (const FloatWindow& window : windows.of_basis)
        if (window.range.count > 0)
            range = {std::min(range.x, window.t_lo), std::max(range.y, window.t_hi)};
    return range;
}

Facing facing(const FloatWindows& x_windows, const FloatWindows& y_windows, glm::vec3 n) {
    // Rounding of the windows' ends must not hide a cut: what is nearly cut is treated as cut.
    constexpr float kMargin = 1e-5F;
    const glm::vec2 x = bounds(x_windows), y = bounds(y_windows);
    if (!(x.x <= x.y && y.x <= y.y))
        return Facing::Away;  // sees nothing of S
    const float margin = kMargin * (1.0F + std::max(std::abs(x.x), std::abs(x.y)) +
                                    std::max(std::abs(y.x), std::abs(y.y)));
    const float least = std::min(n.x * x.x, n.x * x.y) + std::min(n.y * y.x, n.y * y.y) - n.z;
    const float largest = std::max(n.x * x.x, n.x * x.y) + std::max(n.y * y.x, n.y * y.y) - n.z;
    if (least > margin)
        return Facing::Towards;
    return largest < -margin ? Facing::Away : Facing::Cut;
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
    const std::size_t offset = slab.image_offset(channel, m);
    const float* image = offset >= prepared.tail_offset
                             ? prepared.tail.data() + (offset - prepared.tail_offset)
                             : slab.coeffs.data() + offset;
    return image +
           static_cast<std::size_t>(part.y.first) * static_cast<std::size_t>(slab.texels.x) +
           static_cast<std::size_t>(part.x.first);
}

using Sums = std::array<float, 3>;  // of the channels; 0 where there is none

// One image with irradiance weighting: p = n_x X1 - n_z X0, q = n_y X0.
Sums image_sums(const PreparedSlab& prepared, int m, const LitPart& part, const View& view) {
    const auto stride = static_cast<std::size_t>(prepared.slab.texels.x);
    const RowWeights weights{static_cast<std::size_t>(part.y.count),
                             static_cast<std::size_t>(part.x.count),
                             view.p.data() + part.x_at,
                             view.q.data() + part.x_at,
                             view.y.m0.data() + part.y_at,
                             view.y.m1.data() + part.y_at};
    const auto first = [&](int channel) { return first_texel(prepared, channel, m, part); };
    if (prepared.slab.channels == 1)
        return {row_sum(first(0), stride, weights), 0.0F, 0.0F};
    if (weights.columns <= kNarrowColumns)
        return narrow_row_sums({first(0), first(1), first(2)}, stride, weights);
    return {row_sum(first(0), stride, weights), row_sum(first(1), stride, weights),
            row_sum(first(2), stride, weights)};
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

Sums image_sums_radiance(const PreparedSlab& prepared,
                         int m,
                         const LitPart& part,
                         const View& view) {
    Sums sums{};
    for (int c = 0; c < prepared.slab.channels; ++c)
        sums[static_cast<std::size_t>(c)] = image_sum_radiance(prepared, c, m, part, view);
    return sums;
}

// The weights along x that depend on the normal (irradiance weighting: p and q; radiance: centroids
// in p).
void weigh_x(View& view, bool radiance_weighting) {
    const glm::vec3 n = view.normal;
    const std::vector<float>&x0 = view.x.m0, &x1 = view.x.m1;
    view.p.resize(x0.size());
    view.q.resize(x0.size());
    for (std::size_t i = 0; i < x0.size(); ++i) {
        if (radiance_weighting)
            view.p[i] = x0[i] > 0.0F ? x1[i] / x0[i] : 0.0F;
        else
            view.p[i] = n.x * x1[i] - n.z * x0[i];
        view.q[i] = n.y * x0[i];
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
    const auto see_nothing = [&] {
        view.x.of_basis.assign(static_cast<std::size_t>(slab.grid.x), {});
        view.y.of_basis.assign(static_cast<std::size_t>(slab.grid.y), {});
    };
    if (!(p.z > -static_cast<float>(slab.delta_m)))
        return see_nothing();
    fill(view.x, slab, 0, p.x, p.z);
    fill(view.y, slab, 1, p.y, p.z);
    const Facing towards = facing(view.x, view.y, view.normal);
    if (towards == Facing::Away)
        return see_nothing();
    const bool kernel_varies =
        radiance_weighting &&
        std::max(view.x.widest_texel_t, view.y.widest_texel_t) > prepared.widest_centroid_texel_t;
    view.by_pieces = kernel_varies || towards == Facing::Cut;
    if (!view.by_pieces)
        weigh_x(view, radiance_weighting);
}

// Whether any of a run of coefficients is not zero: no branch inside, so that it runs at the speed
// of memory.
bool any_light(const float* coeffs, int count) {
    float sum = 0.0F;
#pragma omp simd reduction(+ : sum)
    for (int k = 0; k < count; ++k)
        sum += coeffs[k];
    return sum > 0.0F;
}

// From the borders inwards, so that a bright image costs next to nothing.
glm::ivec4 lit_texels(const Slab& slab, int m) {
    const int w = slab.texels.x, h = slab.texels.y;
    const auto row = [&](int c, int j) {
        return slab.coeffs.data() + slab.image_offset(c, m) +
               static_cast<std::size_t>(j) * static_cast<std::size_t>(w);
    };
    const auto row_is_lit = [&](int j) {
        bool lit = false;
        for (int c = 0; c < slab.channels; ++c)
            lit = lit || any_light(row(c, j), w);
        return lit;
    };
    int bottom = 0, top = h;
    while (bottom < h && !row_is_lit(bottom))
        ++bottom;
    while (top > bottom && !row_is_lit(top - 1))
        --top;
    int left = w, right = 0;
    for (int j = bottom; j < top; ++j)
        for (int c = 0; c < slab.channels; ++c) {
            const float* texel = row(c, j);
            if (left > 0 && any_light(texel, left))
                left = static_cast<int>(
                    std::find_if(texel, texel + left, [](float v) { return v > 0.0F; }) - texel);
            if (right < w && any_light(texel + right, w - right)) {
                int last = w - 1;
                while (!(texel[last] > 0.0F))
                    --last;
                right = last + 1;
            }
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
    const std::size_t total = slab.coeffs.size(), image = slab.texel_count();
    prepared.tail_offset = total > kRowPadding ? (total - kRowPadding) / image * image : 0;
    prepared.tail.assign(slab.coeffs.begin() + static_cast<std::ptrdiff_t>(prepared.tail_offset),
                         slab.coeffs.end());
    prepared.tail.resize(prepared.tail.size() + kRowPadding, 0.0F);
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
    for (std::size_t m = 0; m < images; ++m) {
        const std::size_t column = m % static_cast<std::size_t>(slab.grid.x);
        const std::size_t row = m / static_cast<std::size_t>(slab.grid.x);
        for (std::size_t k = 0; k < receivers.size(); ++k) {
            const View& view = views[k];
            if (view.by_pieces)
                continue;
            const LitPart part =
                lit_part(view.x.of_basis[column], view.y.of_basis[row], prepared.lit[m]);
            if (part.x.count == 0 || part.y.count == 0)
                continue;
            multiply_adds += 2 * static_cast<std::uint64_t>(slab.channels) *
                             static_cast<std::uint64_t>(part.x.count) *
                             static_cast<std::uint64_t>(part.y.count);
            const auto image = static_cast<int>(m);
            const auto [r, g, b] = radiance_weighting
                                       ? image_sums_radiance(prepared, image, part, view)
                                       : image_sums(prepared, image, part, view);
            const glm::vec3 sums =
                glm::max(slab.channels == 1 ? glm::vec3(r) : glm::vec3(r, g, b), glm::vec3(0.0F)) *
                scale;
            results[k] += sums;
            if (!image_y.empty())
                image_y[k * images + m] = luminance(sums);
        }
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
