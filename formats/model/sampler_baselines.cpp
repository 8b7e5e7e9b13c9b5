// SPDX-License-Identifier: Apache-2.0
// The samplers of Lu, Pacanowski and Granier, as they are printed: what others are measured
// against.
#include "formats/model/sampler_draws.h"
#include "formats/model/sampler_window.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace nearfield::model {
namespace {

using shared::AxisBox;

// A point of an image by its stored CDFs within a box: the marginal over whole columns, as printed.
std::optional<TexelPoint> invert_image(const SamplingSlab& slab,
                                       SamplingView& view,
                                       const SamplerOptions& options,
                                       int image,
                                       const AxisBox& x,
                                       const AxisBox& y,
                                       glm::vec2 xi) {
    const bool is_secant = options.search == Search::Secant;
    const shared::StoredCdf columns = marginal_cdf(slab, image);
    const shared::TexelPick column =
        invert_cdf(columns, restrict_cdf(columns, x), xi.x, is_secant, options.search_steps);
    constexpr std::uint64_t kEnds = 4;  // both ends' texels
    view.reads += kEnds;
    if (column.texel < 0)
        return std::nullopt;
    const shared::StoredCdf rows = conditional_cdf(slab, image, column.texel);
    const shared::TexelPick row =
        invert_cdf(rows, restrict_cdf(rows, y), xi.y, is_secant, options.search_steps);
    view.reads += static_cast<std::uint64_t>(column.steps) + kEnds;
    if (row.texel < 0)
        return std::nullopt;
    view.reads += static_cast<std::uint64_t>(row.steps);
    return TexelPoint{{column.texel, row.texel}, {column.fraction, row.fraction}};
}

// The light of a point drawn in proportion to C_m, `share` of energy each.
void add(const Drawing& drawing,
         std::size_t k,
         int image,
         glm::ivec2 texel,
         const AperturePoint& at,
         double share) {
    const Slab& slab = drawing.slabs[k].prepared.slab;
    const float kernel = light_kernel(slab, drawing.views[k], image, at);
    if (!(kernel > 0.0F))
        return;
    const double most = std::numeric_limits<float>::max();
    const auto weight = static_cast<float>(std::min(share * static_cast<double>(kernel), most));
    drawing.samples.push_back({at.u_m, static_cast<int>(k), image,
                               chroma(slab, drawing.views[k], image, texel) * weight});
}

const AxisBox& box_x(const Drawing& drawing, std::size_t k, int image) {
    return drawing.views[k]
        .x[static_cast<std::size_t>(image % drawing.slabs[k].prepared.slab.grid.x)];
}

const AxisBox& box_y(const Drawing& drawing, std::size_t k, int image) {
    return drawing.views[k]
        .y[static_cast<std::size_t>(image / drawing.slabs[k].prepared.slab.grid.x)];
}

void set_drawn(const Drawing& drawing, double count) {
    for (SamplingView& view : drawing.views)
        view.drawn = static_cast<float>(count);
}

void draw_uniform_image(const Drawing& drawing, std::size_t k, int image, int count) {
    const Slab& slab = drawing.slabs[k].prepared.slab;
    SamplingView& view = drawing.views[k];
    const AxisBox &x = box_x(drawing, k, image), &y = box_y(drawing, k, image);
    const glm::vec2 e_lo(x.e_lo, y.e_lo), e_size(x.e_hi - x.e_lo, y.e_hi - y.e_lo);
    const float area = e_size.x * view.x_view.t_scale * e_size.y * view.y_view.t_scale;
    const auto delta2 = static_cast<float>(
        slab.weighting == Weighting::Irradiance ? slab.delta_m * slab.delta_m : 1.0);
    for (int q = 0; q < count; ++q) {
        const glm::vec2 e =
            e_lo + e_size * plane_point(drawing.options.sequence, static_cast<std::uint32_t>(q),
                                        static_cast<std::uint32_t>(count), drawing.shift);
        const AperturePoint at = aperture_at(view.x_view, view.y_view, e);
        const auto texel = [&](const shared::AxisTexels& s, float u, float p, const AxisBox& box) {
            return std::clamp(texel_of_s(s, shared::s_of_u(u, p, s.delta, s.height), 0.0F),
                              box.first, box.last);
        };
        const glm::ivec2 ij(texel(view.x_texels, at.u_m.x, view.x_view.p, x),
                            texel(view.y_texels, at.u_m.y, view.y_view.p, y));
        const float kernel = light_kernel(slab, view, image, at);
        const glm::vec3 color = texel_color(slab, image, ij);
        view.reads += static_cast<std::uint64_t>(slab.channels);
        if (kernel > 0.0F && color.x + color.y + color.z > 0.0F)
            drawing.samples.push_back(
                {at.u_m, static_cast<int>(k), image,
                 color * (kernel * delta2 * area / static_cast<float>(count))});
    }
}

}  // namespace

void draw_uniform(const Drawing& drawing) {
    const int lit = lamp_energy(drawing.views).lit;
    if (lit == 0)
        return;
    const int count = std::max(1, drawing.options.samples / lit);
    set_drawn(drawing, static_cast<double>(count) * lit);
    for (std::size_t k = 0; k < drawing.slabs.size(); ++k)
        for (std::size_t m = 0; m < drawing.views[k].energy.size(); ++m)
            if (drawing.views[k].energy[m] > 0.0F)
                draw_uniform_image(drawing, k, static_cast<int>(m), count);
}

void draw_pdis(const Drawing& drawing) {
    const SamplerOptions& options = drawing.options;
    const double total = lamp_energy(drawing.views).total;
    double drawn = 0.0;
    for (std::size_t k = 0; k < drawing.slabs.size(); ++k) {
        SamplingView& view = drawing.views[k];
        for (std::size_t m = 0; m < view.energy.size(); ++m) {
            const auto image = static_cast<int>(m);
            const int count =
                view.energy[m] > 0.0F ? pdis_samples(options, total, view.energy[m]) : 0;
            drawn += count;
            const AxisBox &x = box_x(drawing, k, image), &y = box_y(drawing, k, image);
            for (int q = 0; q < count; ++q) {
                const auto point =
                    invert_image(drawing.slabs[k], view, options, image, x, y,
                                 plane_point(options.sequence, static_cast<std::uint32_t>(q),
                                             static_cast<std::uint32_t>(count), drawing.shift));
                if (point)
                    add(drawing, k, image, point->texel, aperture_point(view, x, y, *point),
                        static_cast<double>(view.energy[m]) / count);
            }
        }
    }
    set_drawn(drawing, drawn);
}

void draw_precomputed(const Drawing& drawing) {
    const SamplerOptions& options = drawing.options;
    const double total = lamp_energy(drawing.views).total;
    const auto count = static_cast<std::uint32_t>(options.samples);
    const float start = shared::third_shift(drawing.shift);
    std::uint32_t q = 0;
    double sum = 0.0;
    for (std::size_t k = 0; k < drawing.slabs.size(); ++k) {
        const Slab& slab = drawing.slabs[k].prepared.slab;
        SamplingView& view = drawing.views[k];
        const glm::dvec2 t_per_s(
            std::abs(view.x_view.s_keep + view.x_view.s_slope) * view.x_view.t_scale,
            std::abs(view.y_view.s_keep + view.y_view.s_slope) * view.y_view.t_scale);
        for (std::size_t m = 0; m < view.energy.size(); ++m) {
            sum += static_cast<double>(view.energy[m]);
            for (; q < count && shared::stratum_target(q, start, count, total) < sum; ++q) {
                const auto image = static_cast<int>(m);
                const auto point = invert_image(
                    drawing.slabs[k], view, options, image, shared::whole_axis(slab.texels.x),
                    shared::whole_axis(slab.texels.y),
                    plane_point(options.sequence, q, count, drawing.shift));
                if (!point)
                    continue;
                const glm::vec2 s =
                    glm::vec2(slab.s_min_m) +
                    (glm::vec2(point->texel) + point->fraction) * glm::vec2(slab.texel_m());
                const AperturePoint at = aperture_at(
                    view.x_view, view.y_view, {e_of_s(view.x_view, s.x), e_of_s(view.y_view, s.y)});
                add(drawing, k, image, point->texel, at, total / count * t_per_s.x * t_per_s.y);
            }
        }
    }
}

}  // namespace nearfield::model
