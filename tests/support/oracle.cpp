// SPDX-License-Identifier: Apache-2.0
#include "tests/support/oracle.h"

#include "tests/support/oracle_pieces.h"
#include "tests/support/random.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::support {
namespace {

/// C_m of the images whose support covers a cell, at one texel: [channel][row of images][column of
/// images].
struct LitImages {
    std::vector<double> c;
    bool any = false;
};

/// The slab, its axes, and everything that pieces of U need to be integrated.
struct Integration {
    const Slab& slab;
    const OracleOptions& options;
    Axis x = axis_of(slab, 0), y = axis_of(slab, 1);
    GaussRule rule = gauss_rule(options.order);

    LitImages lit_images(int cell_x, int cell_y, int i, int j) const {
        const int n = x.profile_cells();
        LitImages lit;
        lit.c.assign(static_cast<std::size_t>(slab.channels * n * n), 0.0);
        std::size_t at = 0;
        for (int channel = 0; channel < slab.channels; ++channel)
            for (int row = cell_y - n + 1; row <= cell_y; ++row)
                for (int column = cell_x - n + 1; column <= cell_x; ++column, ++at) {
                    if (row < 0 || row >= slab.grid.y || column < 0 || column >= slab.grid.x)
                        continue;
                    const std::size_t index =
                        slab.image_offset(channel, row * slab.grid.x + column) +
                        static_cast<std::size_t>(j) * static_cast<std::size_t>(slab.texels.x) +
                        static_cast<std::size_t>(i);
                    lit.c[at] = options.coeffs.empty() ? static_cast<double>(slab.coeffs[index])
                                                       : options.coeffs[index];
                    lit.any = lit.any || lit.c[at] != 0.0;
                }
        return lit;
    }
};

glm::dvec3 as_rgb(const std::array<double, 3>& sums, int channels) {
    return channels == 1 ? glm::dvec3(sums[0]) : glm::dvec3(sums[0], sums[1], sums[2]);
}

/// Radiance over sum_m C_m Phi_m.
double radiance_factor(const Slab& slab, double cosine) {
    return slab.weighting == Weighting::Radiance
               ? 1.0
               : slab.delta_m * slab.delta_m / (cosine * cosine * cosine * cosine);
}

/// Adds integral over a rectangle of kernel(u) sum_m C_m Phi_m(u) du to sums.
template <typename Kernel>
void add_rectangle(const Integration& in,
                   const Piece& px,
                   const Piece& py,
                   const LitImages& lit,
                   const Kernel& kernel,
                   std::array<double, 3>& sums) {
    const auto n = static_cast<std::size_t>(in.x.profile_cells());
    const std::size_t order = in.rule.node.size();
    for (std::size_t a = 0; a < order; ++a)
        for (std::size_t b = 0; b < order; ++b) {
            const double weight =
                px.weight_m[a] * py.weight_m[b] * kernel(glm::dvec2(px.u_m[a], py.u_m[b]));
            for (std::size_t channel = 0; channel < static_cast<std::size_t>(in.slab.channels);
                 ++channel) {
                double sum = 0.0;
                for (std::size_t row = 0; row < n; ++row) {
                    double along_row = 0.0;
                    for (std::size_t column = 0; column < n; ++column)
                        along_row +=
                            lit.c[(channel * n + row) * n + column] * px.phi[column * order + a];
                    sum += along_row * py.phi[row * order + b];
                }
                sums[channel] += weight * sum;
            }
        }
}

/// The part of a rectangle where facing(u) >= 0, facing linear, by cutting edges (Sutherland and
/// Hodgman).
template <typename Facing>
std::vector<glm::dvec2> clip_rectangle(const Piece& px, const Piece& py, const Facing& facing) {
    const std::array<glm::dvec2, 4> corners = {{{px.low_m, py.low_m},
                                                {px.high_m, py.low_m},
                                                {px.high_m, py.high_m},
                                                {px.low_m, py.high_m}}};
    std::vector<glm::dvec2> polygon;
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec2 from = corners[k], to = corners[(k + 1) % 4];
        const double at_from = facing(from), at_to = facing(to);
        if (at_from >= 0.0)
            polygon.push_back(from);
        if ((at_from >= 0.0) != (at_to >= 0.0))
            polygon.push_back(from + (to - from) * (at_from / (at_from - at_to)));
    }
    return polygon;
}

/// add_rectangle for a convex polygon within the rectangle: a fan of triangles, each the image of a
/// square.
template <typename Kernel>
void add_polygon(const Integration& in,
                 const Piece& px,
                 const Piece& py,
                 const LitImages& lit,
                 const std::vector<glm::dvec2>& polygon,
                 const Kernel& kernel,
                 std::array<double, 3>& sums) {
    const int n = in.x.profile_cells();
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
        const glm::dvec2 first = polygon[k] - polygon[0], second = polygon[k + 1] - polygon[k];
        const double area2_m2 = std::abs(first.x * second.y - first.y * second.x);
        for (std::size_t a = 0; a < in.rule.node.size(); ++a)
            for (std::size_t b = 0; b < in.rule.node.size(); ++b) {
                const double r = in.rule.node[a];
                const glm::dvec2 u = polygon[0] + r * (first + in.rule.node[b] * second);
                const double weight =
                    in.rule.weight[a] * in.rule.weight[b] * r * area2_m2 * kernel(u);
                std::size_t at = 0;
                for (int channel = 0; channel < in.slab.channels; ++channel)
                    for (int row = py.cell - n + 1; row <= py.cell; ++row)
                        for (int column = px.cell - n + 1; column <= px.cell; ++column, ++at)
                            sums[static_cast<std::size_t>(channel)] +=
                                weight * lit.c[at] * in.x.phi(column, px.cell, u.x) *
                                in.y.phi(row, py.cell, u.y);
            }
    }
}

/// Integral over U of kernel(u) sum_m C_m(s(u)) Phi_m(u) where facing(u) >= 0.
template <typename Kernel, typename Facing>
glm::dvec3 integrate_over_u(const Integration& in,
                            const std::vector<Piece>& pieces_x,
                            const std::vector<Piece>& pieces_y,
                            const Kernel& kernel,
                            const Facing& facing) {
    std::array<double, 3> sums{};
    for (const Piece& py : pieces_y)
        for (const Piece& px : pieces_x) {
            const LitImages lit = in.lit_images(px.cell, py.cell, px.texel, py.texel);
            if (!lit.any)
                continue;
            const std::array<double, 4> corners = {
                facing(glm::dvec2(px.low_m, py.low_m)), facing(glm::dvec2(px.high_m, py.low_m)),
                facing(glm::dvec2(px.low_m, py.high_m)), facing(glm::dvec2(px.high_m, py.high_m))};
            const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
            if (*high <= 0.0)
                continue;
            if (*low >= 0.0)
                add_rectangle(in, px, py, lit, kernel, sums);
            else
                add_polygon(in, px, py, lit, clip_rectangle(px, py, facing), kernel, sums);
        }
    return as_rgb(sums, in.slab.channels);
}

/// Cosine at the receiver (not clamped) times cosine at U over distance squared, times L over sum_m
/// C_m Phi_m.
double irradiance_kernel(const Slab& slab, const model::Receiver& receiver, glm::dvec2 u_m) {
    const glm::dvec3 to_u_m = glm::dvec3(u_m, -slab.delta_m) - receiver.position_m;
    const double distance_m = glm::length(to_u_m);
    const double cosine_receiver = glm::dot(receiver.normal, to_u_m) / distance_m;
    const double cosine_u = -to_u_m.z / distance_m;
    return radiance_factor(slab, cosine_u) * cosine_receiver * cosine_u / (distance_m * distance_m);
}

/// The ray from u through p meets S at s = u + (p_xy - u) delta / (delta + p_z): linear in u.
AxisMap map_through(const Slab& slab, const glm::dvec3& p_m, int d) {
    const double height_m = slab.delta_m + p_m.z;
    return {p_m.z / height_m, p_m[d] * slab.delta_m / height_m};
}

}  // namespace

glm::dvec3 oracle_radiance(const Slab& slab, glm::dvec2 u_m, glm::dvec2 s_m) {
    const Axis x = axis_of(slab, 0), y = axis_of(slab, 1);
    const int i = x.texel_at(s_m.x), j = y.texel_at(s_m.y);
    if (i < 0 || i >= slab.texels.x || j < 0 || j >= slab.texels.y)
        return glm::dvec3(0.0);
    const auto phi = [](const Axis& axis, int basis, double at_m) {
        const double cell = std::floor((at_m - axis.edge_m(0)) / axis.pitch_m);
        return axis.phi(basis, static_cast<int>(cell), at_m);
    };
    std::array<double, 3> sums{};
    for (int channel = 0; channel < slab.channels; ++channel)
        for (int row = 0; row < slab.grid.y; ++row) {
            const double phi_y = phi(y, row, u_m.y);
            for (int column = 0; phi_y != 0.0 && column < slab.grid.x; ++column) {
                const std::size_t texel = static_cast<std::size_t>(j * slab.texels.x + i);
                const double c =
                    slab.coeffs[slab.image_offset(channel, row * slab.grid.x + column) + texel];
                sums[static_cast<std::size_t>(channel)] += c * phi(x, column, u_m.x) * phi_y;
            }
        }
    const double length_m = std::hypot(glm::length(s_m - u_m), slab.delta_m);
    return radiance_factor(slab, slab.delta_m / length_m) * as_rgb(sums, slab.channels);
}

glm::dvec3 oracle_irradiance(const Slab& slab,
                             const model::Receiver& receiver,
                             const OracleOptions& options) {
    const glm::dvec3 p_m = receiver.position_m;
    const double height_m = slab.delta_m + p_m.z;
    if (!(height_m > 0.0))
        return glm::dvec3(0.0);
    const Integration in{slab, options};
    const auto pieces = [&](const Axis& axis, int d) {
        return cut_axis(axis, map_through(slab, p_m, d), {p_m[d], height_m}, in.rule);
    };
    const auto kernel = [&](glm::dvec2 u_m) { return irradiance_kernel(slab, receiver, u_m); };
    const auto facing = [&](glm::dvec2 u_m) {
        return glm::dot(receiver.normal, glm::dvec3(u_m, -slab.delta_m) - p_m);
    };
    return integrate_over_u(in, pieces(in.x, 0), pieces(in.y, 1), kernel, facing);
}

glm::dvec3 oracle_irradiance(const LightField& lightfield,
                             const model::Receiver& receiver,
                             const OracleOptions& options) {
    glm::dvec3 sum(0.0);
    for (const Slab& slab : lightfield.slabs)
        sum += oracle_irradiance(slab, receiver_slab_from_luminaire(slab, receiver), options);
    return sum;
}

std::vector<glm::dvec3> oracle_irradiance(const Slab& slab,
                                          std::span<const model::Receiver> receivers,
                                          const OracleOptions& options) {
    std::vector<glm::dvec3> result(receivers.size());
    tbb::parallel_for(std::size_t{0}, receivers.size(), [&](std::size_t k) {
        result[k] = oracle_irradiance(slab, receivers[k], options);
    });
    return result;
}

glm::dvec3 oracle_intensity(const Slab& slab, glm::dvec3 direction, const OracleOptions& options) {
    const glm::dvec3 d = glm::normalize(direction);
    if (!(d.z > 0.0))
        return glm::dvec3(0.0);
    const Integration in{slab, options};
    const auto pieces = [&](const Axis& axis, int k) {
        return cut_axis(axis, {1.0, slab.delta_m * d[k] / d.z}, {}, in.rule);
    };
    const auto kernel = [&](glm::dvec2) { return radiance_factor(slab, d.z) * d.z; };
    const auto facing = [](glm::dvec2) { return 1.0; };
    return integrate_over_u(in, pieces(in.x, 0), pieces(in.y, 1), kernel, facing);
}

glm::dvec3 oracle_flux(const Slab& slab, int order) {
    OracleOptions options;
    options.order = order;
    const Integration in{slab, options};
    const double delta2_m2 = slab.delta_m * slab.delta_m;
    glm::dvec3 sum(0.0);
    for (int j = 0; j < slab.texels.y; ++j)
        for (int i = 0; i < slab.texels.x; ++i)
            for (std::size_t a = 0; a < in.rule.node.size(); ++a)
                for (std::size_t b = 0; b < in.rule.node.size(); ++b) {
                    // All of U seen from one point of a texel: every u maps to the same s.
                    const glm::dvec2 s_m =
                        slab.s_min_m +
                        slab.texel_m() * glm::dvec2(i + in.rule.node[a], j + in.rule.node[b]);
                    const auto kernel = [&](glm::dvec2 u_m) {
                        const glm::dvec2 across_m = s_m - u_m;
                        const double cosine2 =
                            delta2_m2 / (glm::dot(across_m, across_m) + delta2_m2);
                        return radiance_factor(slab, std::sqrt(cosine2)) * cosine2 * cosine2 /
                               delta2_m2;
                    };
                    const auto pieces = [&](const Axis& axis, int d) {
                        return cut_axis(axis, {0.0, s_m[d]}, {s_m[d], slab.delta_m}, in.rule);
                    };
                    sum += in.rule.weight[a] * in.rule.weight[b] * slab.texel_m().x *
                           slab.texel_m().y *
                           integrate_over_u(in, pieces(in.x, 0), pieces(in.y, 1), kernel,
                                            [](glm::dvec2) { return 1.0; });
                }
    return sum;
}

Estimate oracle_monte_carlo(const Slab& slab,
                            const model::Receiver& receiver,
                            int count,
                            std::uint64_t seed) {
    const Axis x = axis_of(slab, 0), y = axis_of(slab, 1);
    const glm::dvec3 p_m = receiver.position_m;
    const AxisMap map_x = map_through(slab, p_m, 0), map_y = map_through(slab, p_m, 1);
    const glm::dvec2 low_m(x.edge_m(0), y.edge_m(0));
    const glm::dvec2 size_m =
        glm::dvec2(x.edge_m(x.cell_count()), y.edge_m(y.cell_count())) - low_m;
    Random random{seed};
    glm::dvec3 sum(0.0), sum_squares(0.0);
    for (int k = 0; k < count; ++k) {
        const double xi_x = random.uniform(), xi_y = random.uniform();
        const glm::dvec2 u_m = low_m + size_m * glm::dvec2(xi_x, xi_y);
        const glm::dvec3 to_u_m = glm::dvec3(u_m, -slab.delta_m) - p_m;
        const double r2_m2 = glm::dot(to_u_m, to_u_m);
        const double cosines = std::max(0.0, glm::dot(receiver.normal, to_u_m)) * -to_u_m.z / r2_m2;
        const glm::dvec3 value = oracle_radiance(slab, u_m, {map_x.s_m(u_m.x), map_y.s_m(u_m.y)}) *
                                 (cosines / r2_m2 * size_m.x * size_m.y);
        sum += value;
        sum_squares += value * value;
    }
    const glm::dvec3 mean = sum / double(count);
    const glm::dvec3 variance =
        glm::max(glm::dvec3(0.0), sum_squares / double(count) - mean * mean);
    return {mean, glm::sqrt(variance / double(count - 1))};
}

model::Receiver receiver_slab_from_luminaire(const Slab& slab, const model::Receiver& receiver) {
    const glm::dmat3 slab_from_luminaire = glm::transpose(slab.luminaire_from_slab.rotation);
    return {slab_from_luminaire * (receiver.position_m - slab.luminaire_from_slab.translation_m),
            slab_from_luminaire * receiver.normal};
}

}  // namespace nearfield::support
