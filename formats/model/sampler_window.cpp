// SPDX-License-Identifier: Apache-2.0
#include "formats/model/sampler_window.h"

#include "formats/model/profile.h"

#include <algorithm>
#include <cmath>

namespace nearfield::model {
namespace {

using shared::AxisBox;

bool is_resolved(const SamplingSlab& slab,
                 TablePrecision precision,
                 int image,
                 const AxisBox& x,
                 const AxisBox& y,
                 float energy) {
    if (precision == TablePrecision::Float)
        return true;
    const float total = slab.tables.total[static_cast<std::size_t>(image)];
    return shared::is_resolved(energy, total, x, y);
}

float texel_luminance(const Slab& slab, int image, int i, int j) {
    return luminance_of(slab, texel_color(slab, image, {i, j}));
}

float texel_area(const Slab& slab) {
    return static_cast<float>(slab.texel_m().x * slab.texel_m().y);
}

// The box' columns by their texels, to view.columns; returns their sum.
float sum_texels(
    const SamplingSlab& slab, SamplingView& view, int image, const AxisBox& x, const AxisBox& y) {
    const Slab& lamp = slab.prepared.slab;
    view.columns.assign(static_cast<std::size_t>(x.last - x.first + 1), 0.0F);
    for (int j = y.first; j <= y.last; ++j)
        for (int i = x.first; i <= x.last; ++i)
            view.columns[static_cast<std::size_t>(i - x.first)] +=
                texel_width(y, j) * texel_luminance(lamp, image, i, j);
    view.reads += view.columns.size() * static_cast<std::size_t>(y.last - y.first + 1) *
                  static_cast<std::size_t>(lamp.channels);
    float sum = 0.0F;
    for (int i = x.first; i <= x.last; ++i) {
        float& column = view.columns[static_cast<std::size_t>(i - x.first)];
        column *= texel_width(x, i) * texel_area(lamp);
        sum += column;
    }
    return sum;
}

// Where a running sum of count terms passes the target; a term of 0 is never chosen.
template <typename Term>
shared::TexelPick pick_by_terms(int count, float target, const Term& term) {
    shared::TexelPick pick{-1, 0.5F, 0};
    float left = target;
    for (int k = 0; k < count; ++k) {
        const float value = term(k);
        if (!(value > 0.0F))
            continue;
        pick.texel = k;
        pick.fraction = shared::fraction_of(left, value);
        if (left < value)
            break;
        left -= value;
    }
    return pick;
}

std::optional<TexelPoint> pick_by_texels(const SamplingSlab& slab,
                                         SamplingView& view,
                                         const Window& window,
                                         glm::vec2 coordinates) {
    const Slab& lamp = slab.prepared.slab;
    const shared::TexelPick column =
        pick_by_terms(static_cast<int>(view.columns.size()), coordinates.x * window.energy,
                      [&](int k) { return view.columns[static_cast<std::size_t>(k)]; });
    if (column.texel < 0)
        return std::nullopt;
    const int i = window.x.first + column.texel;
    const auto row_energy = [&](int k) {
        const int j = window.y.first + k;
        return texel_width(window.y, j) * texel_luminance(lamp, window.image, i, j);
    };
    const int rows = window.y.last - window.y.first + 1;
    float sum = 0.0F;
    for (int k = 0; k < rows; ++k)
        sum += row_energy(k);
    view.reads += static_cast<std::uint64_t>(2 * rows * lamp.channels);
    const shared::TexelPick row = pick_by_terms(rows, coordinates.y * sum, row_energy);
    return TexelPoint{{i, window.y.first + row.texel}, {column.fraction, row.fraction}};
}

bool is_lit(const SamplingSlab& slab, int image, const AxisBox& x, const AxisBox& y) {
    return x.first <= x.last && y.first <= y.last &&
           meets_light(slab, image, {x.first, y.first}, {x.last, y.last});
}

}  // namespace

bool meets_light(const SamplingSlab& slab, int image, glm::ivec2 lo, glm::ivec2 hi) {
    const glm::ivec4 lit = slab.prepared.lit[static_cast<std::size_t>(image)];
    return lo.x < lit[2] && hi.x >= lit[0] && lo.y < lit[3] && hi.y >= lit[1];
}

shared::AreaTable area_table(const SamplingSlab& slab, TablePrecision precision, int image) {
    const glm::ivec2 texels = slab.prepared.slab.texels;
    const std::size_t at = static_cast<std::size_t>(image) *
                           static_cast<std::size_t>(texels.x + 1) *
                           static_cast<std::size_t>(texels.y + 1);
    const float* lo = precision == TablePrecision::Pair ? slab.tables.sat_lo.data() + at : nullptr;
    return {slab.tables.sat_hi.data() + at, lo, texels.x + 1};
}

std::uint64_t corner_reads(const shared::AreaTable& table, int corners) {
    return static_cast<std::uint64_t>(table.lo == nullptr ? corners : 2 * corners);
}

float resolved_energy(const SamplingSlab& slab,
                      SamplingView& view,
                      TablePrecision precision,
                      int image,
                      const AxisBox& x,
                      const AxisBox& y,
                      float found) {
    if (is_resolved(slab, precision, image, x, y, found))
        return found;
    return is_lit(slab, image, x, y) ? sum_texels(slab, view, image, x, y) : 0.0F;
}

float window_energy(const SamplingSlab& slab,
                    SamplingView& view,
                    TablePrecision precision,
                    int image,
                    const AxisBox& x,
                    const AxisBox& y) {
    if (!is_lit(slab, image, x, y))
        return 0.0F;
    const shared::AreaTable table = area_table(slab, precision, image);
    const float found = box_energy(table, x, y);
    view.reads += corner_reads(table, 16);
    return resolved_energy(slab, view, precision, image, x, y, found);
}

Window open_window(const SamplingSlab& slab,
                   SamplingView& view,
                   TablePrecision precision,
                   int image,
                   const AxisBox& x,
                   const AxisBox& y) {
    Window window{image, x, y, area_table(slab, precision, image), {}, {}, false, 0.0F};
    if (!is_lit(slab, image, x, y))
        return window;
    window.corners = box_corners(window.table, x, y);
    window.blocks = box_blocks(window.corners, x, y);
    window.energy = shared::sum_of(column_energies(window.blocks));
    view.reads += corner_reads(window.table, 16);
    window.is_by_texels = !is_resolved(slab, precision, image, x, y, window.energy);
    if (window.is_by_texels)
        window.energy = sum_texels(slab, view, image, x, y);
    return window;
}

std::optional<TexelPoint> pick_point(const SamplingSlab& slab,
                                     SamplingView& view,
                                     const Window& window,
                                     glm::vec2 coordinates) {
    if (!(window.energy > 0.0F))
        return std::nullopt;
    if (window.is_by_texels)
        return pick_by_texels(slab, view, window, coordinates);
    const shared::BoxPick pick =
        pick_in_box(window.table, window.corners, window.blocks, window.x, window.y, coordinates);
    view.reads += corner_reads(window.table, 2 * pick.steps);
    if (pick.texel.x < 0)
        return std::nullopt;
    return TexelPoint{pick.texel, pick.fraction};
}

glm::vec2 invert_point(const SamplingSlab& slab,
                       const SamplingView& view,
                       const Window& window,
                       const TexelPoint& point) {
    const AxisBox &x = window.x, &y = window.y;
    if (!window.is_by_texels)
        return invert_in_box(window.table, window.blocks, x, y, point.texel, point.fraction);
    const auto row_energy = [&](int j) {
        return texel_width(y, j) *
               texel_luminance(slab.prepared.slab, window.image, point.texel.x, j);
    };
    float left = 0.0F, below = 0.0F, column = 0.0F;
    for (int i = x.first; i < point.texel.x; ++i)
        left += view.columns[static_cast<std::size_t>(i - x.first)];
    for (int j = y.first; j <= y.last; ++j) {
        below += j < point.texel.y ? row_energy(j) : 0.0F;
        column += row_energy(j);
    }
    const float own = view.columns[static_cast<std::size_t>(point.texel.x - x.first)];
    return {shared::fraction_of(left + point.fraction.x * own, window.energy),
            shared::fraction_of(below + point.fraction.y * row_energy(point.texel.y), column)};
}

AperturePoint aperture_point(const SamplingView& view,
                             const AxisBox& x,
                             const AxisBox& y,
                             const TexelPoint& point) {
    return aperture_at(view.x_view, view.y_view,
                       {e_in_box(view.x_view, view.x_texels, x, point.texel.x, point.fraction.x),
                        e_in_box(view.y_view, view.y_texels, y, point.texel.y, point.fraction.y)});
}

float light_kernel(const Slab& slab,
                   const SamplingView& view,
                   int image,
                   const AperturePoint& point) {
    const float cosine = shared::kernel_cosine(view.receiver.normal, point.t);
    if (!(cosine > 0.0F))
        return 0.0F;
    return shared::light_kernel(basis_at(slab, image, point.u_m), cosine, point.t,
                                slab.weighting == Weighting::Radiance);
}

float basis_at(const Slab& slab, int image, glm::vec2 u_m) {
    const glm::vec2 center(slab.basis_center_m(image % slab.grid.x, image / slab.grid.x));
    const glm::vec2 x = (u_m - center) / glm::vec2(slab.pitch_m);
    return static_cast<float>(eval(slab.profile, x.x) * eval(slab.profile, x.y));
}

glm::vec3 texel_color(const Slab& slab, int image, glm::ivec2 texel) {
    const std::size_t at =
        static_cast<std::size_t>(texel.y) * static_cast<std::size_t>(slab.texels.x) +
        static_cast<std::size_t>(texel.x);
    if (slab.channels == 1)
        return glm::vec3(slab.coeffs[slab.image_offset(0, image) + at]);
    return {slab.coeffs[slab.image_offset(0, image) + at],
            slab.coeffs[slab.image_offset(1, image) + at],
            slab.coeffs[slab.image_offset(2, image) + at]};
}

float luminance_of(const Slab& slab, glm::vec3 color) {
    return slab.channels == 1
               ? color.x
               : glm::dot(color, glm::vec3(glm::dvec3(kLuminanceRgb[0], kLuminanceRgb[1],
                                                      kLuminanceRgb[2])));
}

glm::vec3 chroma(const Slab& slab, SamplingView& view, int image, glm::ivec2 texel) {
    if (slab.channels == 1)
        return glm::vec3(1.0F);
    const glm::vec3 color = texel_color(slab, image, texel);
    view.reads += static_cast<std::uint64_t>(slab.channels);
    const float luminance = luminance_of(slab, color);
    return luminance > 0.0F ? color / luminance : glm::vec3(0.0F);
}

float energy_scale(const Slab& slab) {
    const double per_texel = 1.0 / (slab.texel_m().x * slab.texel_m().y);
    return static_cast<float>(slab.weighting == Weighting::Irradiance
                                  ? slab.delta_m * slab.delta_m * per_texel
                                  : per_texel);
}

}  // namespace nearfield::model
