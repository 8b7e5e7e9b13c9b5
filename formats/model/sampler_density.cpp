// SPDX-License-Identifier: Apache-2.0
// Densities of samplers, and the inverse of restricted sampling.
#include "formats/model/profile.h"
#include "formats/model/sampler.h"
#include "formats/model/sampler_draws.h"
#include "formats/model/sampler_window.h"

#include <algorithm>
#include <cmath>

namespace nearfield::model {
namespace {

using shared::AxisBox;

// A point of U as one receiver sees it: in e along both axes, and the texel behind it.
struct SeenPoint {
    glm::vec2 u_m, e;
    glm::ivec2 texel;
    glm::vec2 in_texel;  // along S, in [0, 1)
    bool is_on_s;
};

SeenPoint see(const SamplingView& view, glm::vec2 u_m) {
    const shared::AxisTexels &x = view.x_texels, &y = view.y_texels;
    const glm::vec2 s(shared::s_of_u(u_m.x, view.x_view.p, x.delta, x.height),
                      shared::s_of_u(u_m.y, view.y_view.p, y.delta, y.height));
    const glm::ivec2 texel(texel_of_s(x, s.x, 0.0F), texel_of_s(y, s.y, 0.0F));
    return {u_m,
            {e_of_u(view.x_view, u_m.x), e_of_u(view.y_view, u_m.y)},
            texel,
            glm::fract(glm::vec2((s.x - x.s_min) / x.texel, (s.y - y.s_min) / y.texel)),
            texel.x >= 0 && texel.x < x.texels && texel.y >= 0 && texel.y < y.texels};
}

bool holds(const AxisBox& box, float e) {
    return box.first <= box.last && e >= box.e_lo && e < box.e_hi;
}

// The cell of Phi_m's support along one axis that holds u; -1 or n outside.
int cell_of(const Slab& slab, int axis, int k, float u_m) {
    const auto n = static_cast<int>(slab.profile.cells.size());
    const double center_m = axis == 0 ? slab.basis_center_m(k, 0).x : slab.basis_center_m(0, k).y;
    const double x = (static_cast<double>(u_m) - center_m) / slab.pitch_m[axis] + 0.5 * n;
    return static_cast<int>(std::clamp(std::floor(x), -1.0, static_cast<double>(n)));
}

// The boxes that a sampler draws from for an image at a point; false where it draws nothing there.
struct DrawnBox {
    AxisBox x, y;
    glm::ivec2 cell;  // Cells
    bool is_drawn;
};

DrawnBox drawn_box(const Slab& slab,
                   const SamplingView& view,
                   Sampler sampler,
                   int image,
                   const SeenPoint& point) {
    const glm::ivec2 grid(image % slab.grid.x, image / slab.grid.x);
    glm::ivec2 cell(0);
    if (sampler == Sampler::Cells) {
        const auto n = static_cast<int>(slab.profile.cells.size());
        cell = {cell_of(slab, 0, grid.x, point.u_m.x), cell_of(slab, 1, grid.y, point.u_m.y)};
        if (std::min(cell.x, cell.y) < 0 || std::max(cell.x, cell.y) >= n)
            return {{}, {}, cell, false};
    }
    const AxisBox& x = view.x[static_cast<std::size_t>(grid.x + cell.x)];
    const AxisBox& y = view.y[static_cast<std::size_t>(grid.y + cell.y)];
    return {x, y, cell, holds(x, point.e.x) && holds(y, point.e.y)};
}

float texel_luminance(const Slab& slab, int image, glm::ivec2 texel) {
    return luminance_of(slab, texel_color(slab, image, texel));
}

// The coordinates at which an image's own CDFs give a place in a box.
glm::vec2 invert_stored(const SamplingSlab& slab,
                        int image,
                        const AxisBox& x,
                        const AxisBox& y,
                        const TexelPoint& place) {
    const auto along = [](shared::StoredCdf cdf, const AxisBox& box, int i, float fraction) {
        return shared::fraction_of(rise_until(cdf, box, i, fraction),
                                   rise_until(cdf, box, box.last, 1.0F));
    };
    return {along(marginal_cdf(slab, image), x, place.texel.x, place.fraction.x),
            along(conditional_cdf(slab, image, place.texel.x), y, place.texel.y, place.fraction.y)};
}

// Density per m^2 on U of an image's own CDFs within boxes.
float stored_density(const SamplingSlab& slab,
                     const SamplingView& view,
                     int image,
                     const AxisBox& x,
                     const AxisBox& y,
                     glm::ivec2 texel) {
    const float distance = view.x_texels.delta + view.x_texels.height;
    const glm::ivec2 inside(std::clamp(texel.x, x.first, x.last),
                            std::clamp(texel.y, y.first, y.last));
    return cdf_density(marginal_cdf(slab, image), x, inside.x, view.x[0].texel_width * distance) *
           cdf_density(conditional_cdf(slab, image, inside.x), y, inside.y,
                       view.y[0].texel_width * distance);
}

float joint_density(const SamplingSlab& slab,
                    const SamplingView& view,
                    const SamplerOptions& options,
                    float lamp_total,
                    int image,
                    const SeenPoint& point) {
    const Slab& lamp = slab.prepared.slab;
    const float distance = view.x_texels.delta + view.x_texels.height;
    if (options.sampler == Sampler::Precomputed)
        return view.energy[static_cast<std::size_t>(image)] / lamp_total *
               stored_density(slab, view, image, shared::whole_axis(lamp.texels.x),
                              shared::whole_axis(lamp.texels.y), point.texel);
    const DrawnBox box = drawn_box(lamp, view, options.sampler, image, point);
    if (!box.is_drawn)
        return 0.0F;
    const float delta2 =
        lamp.weighting == Weighting::Irradiance ? view.x_texels.delta * view.x_texels.delta : 1.0F;
    const float restricted =
        texel_luminance(lamp, image, point.texel) * delta2 / (distance * distance * lamp_total);
    switch (options.sampler) {
        case Sampler::Uniform:
            return view.energy[static_cast<std::size_t>(image)] /
                   (lamp_total * (box.x.e_hi - box.x.e_lo) * view.x_view.u_scale *
                    (box.y.e_hi - box.y.e_lo) * view.y_view.u_scale);
        case Sampler::Pdis:
            return static_cast<float>(pdis_samples(options, static_cast<double>(lamp_total),
                                                   view.energy[static_cast<std::size_t>(image)])) /
                   view.drawn * stored_density(slab, view, image, box.x, box.y, point.texel);
        case Sampler::Cells:
            return restricted *
                   static_cast<float>(integral(lamp.profile, static_cast<std::size_t>(box.cell.x)) *
                                      integral(lamp.profile, static_cast<std::size_t>(box.cell.y)));
        case Sampler::Systematic:
        case Sampler::Precomputed:
            break;
    }
    return restricted;
}

// Basis functions along an axis whose support may hold u: first and last.
glm::ivec2 covering(const Slab& slab, int axis, float u_m) {
    const auto n = static_cast<int>(slab.profile.cells.size());
    const double x =
        (static_cast<double>(u_m) - slab.basis_center_m(0, 0)[axis]) / slab.pitch_m[axis] + 0.5 * n;
    const auto cell =
        static_cast<int>(std::clamp(std::floor(x), -2.0, static_cast<double>(slab.grid[axis] + n)));
    // One further on both sides: rounding may see u across an edge.
    return {std::max(cell - n, 0), std::min(cell + 1, slab.grid[axis] - 1)};
}

}  // namespace

shared::StoredCdf marginal_cdf(const SamplingSlab& slab, int image) {
    const auto w = static_cast<std::size_t>(slab.prepared.slab.texels.x);
    return {slab.tables.marginal_cdf.data() + static_cast<std::size_t>(image) * (w + 1)};
}

shared::StoredCdf conditional_cdf(const SamplingSlab& slab, int image, int column) {
    const auto w = static_cast<std::size_t>(slab.prepared.slab.texels.x);
    const auto h = static_cast<std::size_t>(slab.prepared.slab.texels.y);
    const std::size_t at = static_cast<std::size_t>(image) * w + static_cast<std::size_t>(column);
    return {slab.tables.conditional_cdf.data() + at * (h + 1)};
}

float joint_density_u(const SamplingSlab& slab,
                      const SamplingView& view,
                      const SamplerOptions& options,
                      float lamp_total,
                      int image,
                      glm::vec2 u_m) {
    if (!(view.total > 0.0F))
        return 0.0F;
    const SeenPoint point = see(view, u_m);
    return point.is_on_s ? joint_density(slab, view, options, lamp_total, image, point) : 0.0F;
}

float marginal_density_u(const SamplingSlab& slab,
                         const SamplingView& view,
                         const SamplerOptions& options,
                         float lamp_total,
                         glm::vec2 u_m) {
    if (!(view.total > 0.0F))
        return 0.0F;
    const SeenPoint point = see(view, u_m);
    if (!point.is_on_s)
        return 0.0F;
    const Slab& lamp = slab.prepared.slab;
    const bool is_restricted = options.sampler != Sampler::Precomputed;
    const glm::ivec2 columns =
        is_restricted ? covering(lamp, 0, u_m.x) : glm::ivec2(0, lamp.grid.x - 1);
    const glm::ivec2 rows =
        is_restricted ? covering(lamp, 1, u_m.y) : glm::ivec2(0, lamp.grid.y - 1);
    float density = 0.0F;
    for (int row = rows[0]; row <= rows[1]; ++row)
        for (int column = columns[0]; column <= columns[1]; ++column)
            density +=
                joint_density(slab, view, options, lamp_total, row * lamp.grid.x + column, point);
    return density;
}

float marginal_density_omega(const SamplingSlab& slab,
                             const SamplingView& view,
                             const SamplerOptions& options,
                             float lamp_total,
                             glm::vec2 u_m) {
    const float distance =
        static_cast<float>(slab.prepared.slab.delta_m) + view.receiver.position_m.z;
    if (!(distance > 0.0F))
        return 0.0F;
    const glm::vec2 t = (u_m - glm::vec2(view.receiver.position_m)) / distance;
    return marginal_density_u(slab, view, options, lamp_total, u_m) *
           shared::omega_per_u(t, distance);
}

glm::vec2 inverse_u(const SamplingSlab& slab,
                    const SamplingView& view,
                    const SamplerOptions& options,
                    int image,
                    glm::vec2 u_m) {
    const Slab& lamp = slab.prepared.slab;
    const SeenPoint point = see(view, u_m);
    if (!point.is_on_s)
        return glm::vec2(0.0F);
    if (options.sampler == Sampler::Precomputed)
        return invert_stored(slab, image, shared::whole_axis(lamp.texels.x),
                             shared::whole_axis(lamp.texels.y), {point.texel, point.in_texel});
    const DrawnBox box = drawn_box(lamp, view, options.sampler, image, point);
    if (!box.is_drawn)
        return glm::vec2(0.0F);
    if (options.sampler == Sampler::Uniform)
        return {shared::fraction_of(point.e.x - box.x.e_lo, box.x.e_hi - box.x.e_lo),
                shared::fraction_of(point.e.y - box.y.e_lo, box.y.e_hi - box.y.e_lo)};
    const glm::ivec2 texel(std::clamp(point.texel.x, box.x.first, box.x.last),
                           std::clamp(point.texel.y, box.y.first, box.y.last));
    const auto fraction = [](const shared::AxisView& v, const shared::AxisTexels& s,
                             const AxisBox& b, int i, float e) {
        const shared::Interval part = texel_part(v, s, b.e_lo, b.e_hi, i);
        return shared::fraction_of(e - part.lo, part.hi - part.lo);
    };
    const TexelPoint place{texel,
                           {fraction(view.x_view, view.x_texels, box.x, texel.x, point.e.x),
                            fraction(view.y_view, view.y_texels, box.y, texel.y, point.e.y)}};
    if (options.sampler == Sampler::Pdis)
        return invert_stored(slab, image, box.x, box.y, place);
    SamplingView scratch;
    const Window window = open_window(slab, scratch, options.precision, image, box.x, box.y);
    return invert_point(slab, scratch, window, place);
}

glm::vec3 radiance_towards(const PreparedSlab& slab, glm::vec3 p_m, glm::vec2 u_m) {
    const Slab& lamp = slab.slab;
    const auto delta_m = static_cast<float>(lamp.delta_m);
    const float distance = delta_m + p_m.z;
    if (!(distance > 0.0F))
        return glm::vec3(0.0F);
    const glm::vec2 s(shared::s_of_u(u_m.x, p_m.x, delta_m, p_m.z),
                      shared::s_of_u(u_m.y, p_m.y, delta_m, p_m.z));
    const glm::vec2 texel = glm::floor((s - glm::vec2(lamp.s_min_m)) / glm::vec2(lamp.texel_m()));
    if (!(texel.x >= 0.0F && texel.x < static_cast<float>(lamp.texels.x) && texel.y >= 0.0F &&
          texel.y < static_cast<float>(lamp.texels.y)))
        return glm::vec3(0.0F);
    const glm::ivec2 columns = covering(lamp, 0, u_m.x), rows = covering(lamp, 1, u_m.y);
    glm::vec3 sum(0.0F);
    for (int row = rows[0]; row <= rows[1]; ++row)
        for (int column = columns[0]; column <= columns[1]; ++column) {
            const int image = row * lamp.grid.x + column;
            const float basis = basis_at(lamp, image, u_m);
            if (basis > 0.0F)
                sum += basis * texel_color(lamp, image, glm::ivec2(texel));
        }
    if (lamp.weighting == Weighting::Radiance)
        return sum;
    const glm::vec2 t = (u_m - glm::vec2(p_m)) / distance;
    const float r2 = 1.0F + glm::dot(t, t);  // 1 / cos^2
    return sum * (delta_m * delta_m * r2 * r2);
}

}  // namespace nearfield::model
