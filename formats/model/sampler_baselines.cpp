// SPDX-License-Identifier: Apache-2.0
// The samplers of Lu, Pacanowski and Granier, as they are printed: what others are measured
// against.
#include "formats/model/sampler_draws.h"
#include "formats/model/sampler_window.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace nearfield::model {
namespace {

using shared::AxisBox;

constexpr float kBelowOne = 0x1.fffffep-1F;

// A stored CDF along one axis, restricted to a box by an affine transformation (eq. (8)): positions
// in texels and the CDF at its ends.
struct RestrictedCdf {
    const float* cdf;
    int first, last;
    float x_lo, x_hi;  // ends of the box, in texels
    float c_lo, c_hi;  // the CDF there
};

RestrictedCdf restrict_cdf(const float* cdf, const AxisBox& box) {
    const float part_first = std::min(box.first_width / box.texel_width, 1.0F);
    const float part_last = std::min(box.last_width / box.texel_width, 1.0F);
    const float step_first = cdf[box.first + 1] - cdf[box.first];
    RestrictedCdf r{cdf, box.first, box.last, 0.0F, 0.0F, 0.0F, 0.0F};
    r.x_lo = static_cast<float>(box.first + 1) - part_first;
    r.c_lo = cdf[box.first + 1] - part_first * step_first;
    // Of a single texel any stretch as long as the box' is as good: the CDF is linear in it.
    r.x_hi = static_cast<float>(box.first == box.last ? box.first + 1 : box.last) + part_last;
    r.c_hi = box.first == box.last
                 ? cdf[box.first + 1]
                 : cdf[box.last] + part_last * (cdf[box.last + 1] - cdf[box.last]);
    return r;
}

// The texel where the CDF passes c_lo + xi (c_hi - c_lo), and where in its part of the box.
// Bisection or the paper's secant on whole texels; cut short after max_steps (0: never) the CDF is
// taken as linear over what is left. Nothing where the CDF does not rise: 0/0 as printed.
std::optional<shared::TexelPick> invert(const RestrictedCdf& r,
                                        float xi,
                                        Search search,
                                        int max_steps) {
    if (!(r.c_hi > r.c_lo))
        return std::nullopt;
    const float target = r.c_lo + xi * (r.c_hi - r.c_lo);
    int lo = r.first, hi = r.last + 1, steps = 0;
    float c_lo = r.c_lo, c_hi = r.c_hi;
    while (hi - lo > 1 && (max_steps == 0 || steps < max_steps)) {
        int middle = (lo + hi) / 2;
        if (search == Search::Secant) {
            const float along = (target - c_lo) / (c_hi - c_lo);
            middle = lo + static_cast<int>(along * static_cast<float>(hi - lo));
            middle = std::clamp(middle, lo + 1, hi - 1);
        }
        ++steps;
        const float value = r.cdf[middle];
        if (target < value) {
            hi = middle;
            c_hi = value;
        } else {
            lo = middle;
            c_lo = value;
        }
    }
    const float x_lo = std::max(static_cast<float>(lo), r.x_lo);
    const float x_hi = std::min(static_cast<float>(hi), r.x_hi);
    const float x = x_lo + shared::fraction_of(target - c_lo, c_hi - c_lo) * (x_hi - x_lo);
    shared::TexelPick pick{};
    pick.texel = std::clamp(static_cast<int>(std::floor(x)), lo, hi - 1);
    const float begin = std::max(static_cast<float>(pick.texel), r.x_lo);
    const float end = std::min(static_cast<float>(pick.texel + 1), r.x_hi);
    pick.fraction = shared::fraction_of(x - begin, end - begin);
    pick.steps = steps;
    return pick;
}

// A point of an image by its stored CDFs within a box: the marginal over whole columns, as printed.
std::optional<TexelPoint> invert_image(const SamplingSlab& slab,
                                       SamplingView& view,
                                       const SamplerOptions& options,
                                       int image,
                                       const AxisBox& x,
                                       const AxisBox& y,
                                       glm::vec2 xi) {
    const auto w = static_cast<std::size_t>(slab.prepared.slab.texels.x);
    const auto h = static_cast<std::size_t>(slab.prepared.slab.texels.y);
    const auto m = static_cast<std::size_t>(image);
    const auto column = invert(restrict_cdf(slab.tables.marginal_cdf.data() + m * (w + 1), x), xi.x,
                               options.search, options.search_steps);
    constexpr std::uint64_t kEnds = 4;  // both ends' texels
    view.reads += kEnds;
    if (!column)
        return std::nullopt;
    const float* conditional = slab.tables.conditional_cdf.data() +
                               (m * w + static_cast<std::size_t>(column->texel)) * (h + 1);
    const auto row =
        invert(restrict_cdf(conditional, y), xi.y, options.search, options.search_steps);
    view.reads += static_cast<std::uint64_t>(column->steps) + kEnds;
    if (!row)
        return std::nullopt;
    view.reads += static_cast<std::uint64_t>(row->steps);
    return TexelPoint{{column->texel, row->texel}, {column->fraction, row->fraction}};
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
        const AperturePoint at{{u_of_e(view.x_view, e.x), u_of_e(view.y_view, e.y)},
                               {t_of_e(view.x_view, e.x), t_of_e(view.y_view, e.y)}};
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

int pdis_samples(const SamplerOptions& options, double lamp_total, float energy) {
    const double exact = options.samples * static_cast<double>(energy) / lamp_total;
    const auto rounded = static_cast<int>(std::floor(exact + 0.5));
    return options.k_max > 0 ? std::min(rounded, options.k_max) : rounded;
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
    const double total = lamp_energy(drawing.views).total, count = options.samples;
    const double start = third_shift(drawing.shift);
    int q = 0;
    double sum = 0.0;
    for (std::size_t k = 0; k < drawing.slabs.size(); ++k) {
        const Slab& slab = drawing.slabs[k].prepared.slab;
        SamplingView& view = drawing.views[k];
        const glm::dvec2 t_per_s(
            std::abs(view.x_view.s_keep + view.x_view.s_slope) * view.x_view.t_scale,
            std::abs(view.y_view.s_keep + view.y_view.s_slope) * view.y_view.t_scale);
        for (std::size_t m = 0; m < view.energy.size(); ++m) {
            sum += static_cast<double>(view.energy[m]);
            for (; q < options.samples && (q + start) / count * total < sum; ++q) {
                const auto image = static_cast<int>(m);
                const auto point = invert_image(
                    drawing.slabs[k], view, options, image, whole_axis(slab.texels.x),
                    whole_axis(slab.texels.y),
                    plane_point(options.sequence, static_cast<std::uint32_t>(q),
                                static_cast<std::uint32_t>(options.samples), drawing.shift));
                if (!point)
                    continue;
                const glm::vec2 s =
                    glm::vec2(slab.s_min_m) +
                    (glm::vec2(point->texel) + point->fraction) * glm::vec2(slab.texel_m());
                const glm::vec2 e(e_of_s(view.x_view, s.x), e_of_s(view.y_view, s.y));
                const AperturePoint at{{u_of_e(view.x_view, e.x), u_of_e(view.y_view, e.y)},
                                       {t_of_e(view.x_view, e.x), t_of_e(view.y_view, e.y)}};
                add(drawing, k, image, point->texel, at, total / count * t_per_s.x * t_per_s.y);
            }
        }
    }
}

}  // namespace nearfield::model
