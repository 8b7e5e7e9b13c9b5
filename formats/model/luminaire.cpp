// SPDX-License-Identifier: Apache-2.0
#include "formats/model/luminaire.h"

#include "formats/model/intensity_sigma.h"
#include "formats/model/profile.h"
#include "formats/model/window_sum.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace nearfield::model {
namespace {

using Sums = std::array<double, 3>;

glm::dvec3 color(const Slab& slab, const Sums& sums) {
    return slab.channels == 1 ? glm::dvec3(sums[0]) : glm::dvec3(sums[0], sums[1], sums[2]);
}

double square(double x) {
    return x * x;
}

// int Phi_m du, in m^2.
double support_integral_m2(const Slab& slab) {
    return square(integral(slab.profile)) * slab.pitch_m.x * slab.pitch_m.y;
}

// Most parts into which quadratures split a length: beyond, a slab is no lamp, and time is bounded.
constexpr double kMostParts = 1e4;

// Nodes of a quadrature rule along one axis, relative to a center.
struct Nodes {
    std::vector<double> offset_m, weight_m;
};

// Gauss-Legendre with 3 nodes on parts no wider than widest_m of [lo_m, hi_m].
void append_nodes(Nodes& nodes, double lo_m, double hi_m, double widest_m) {
    constexpr std::array<double, 3> kNode = {-0.7745966692414834, 0.0, 0.7745966692414834};
    constexpr std::array<double, 3> kWeight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    const int parts =
        std::max(1, static_cast<int>(std::ceil(std::min((hi_m - lo_m) / widest_m, kMostParts))));
    const double step = (hi_m - lo_m) / parts;
    for (int k = 0; k < parts; ++k)
        for (std::size_t q = 0; q < kNode.size(); ++q) {
            nodes.offset_m.push_back(lo_m + step * (k + 0.5 + 0.5 * kNode[q]));
            nodes.weight_m.push_back(step * kWeight[q]);
        }
}

// int phi(u) f(u) du about a basis function's center.
Nodes basis_nodes(const Slab& slab, int axis, double widest_m) {
    const auto n = static_cast<double>(slab.profile.cells.size());
    const double pitch = slab.pitch_m[axis];
    Nodes nodes;
    for (std::size_t c = 0; c < slab.profile.cells.size(); ++c) {
        const double lo = (static_cast<double>(c) - 0.5 * n) * pitch;
        append_nodes(nodes, lo, lo + pitch, widest_m);
    }
    for (std::size_t k = 0; k < nodes.offset_m.size(); ++k)
        nodes.weight_m[k] *= eval(slab.profile, nodes.offset_m[k] / pitch);
    return nodes;
}

// Flux of a coefficient of one in texel (i, j) of image (column, row):
//     irradiance weighting  int ds int Phi_m du
//     radiance weighting    int ds int Phi_m k du,  k = cos^4(theta) / delta^2 = delta^2 / r^4
// Over u by 3 Gauss nodes a cell; over a texel by its midpoint and the second derivatives there,
//     mean k = k (1 + sum_x,y h^2 (24 x^2 / r^2 - 4) / (24 r^2)),
// which leaves 1e-6 of a texel of delta / 16; larger ones are split.
class TexelFlux {
  public:
    explicit TexelFlux(const Slab& slab) : slab_(slab) {
        const glm::dvec2 texel = slab.texel_m();
        constant_ = texel.x * texel.y * support_integral_m2(slab);
        if (slab.weighting == Weighting::Irradiance)
            return;
        for (int axis = 0; axis < 2; ++axis) {
            u_[axis] = basis_nodes(slab, axis, slab.delta_m / 4.0);
            // Clamped before the conversion: a texel may be any multiple of delta.
            parts_[axis] = static_cast<int>(
                std::clamp(std::ceil(16.0 * texel[axis] / slab.delta_m), 1.0, kMostParts));
        }
        part_m_ = texel / glm::dvec2(parts_);
    }

    double operator()(int column, int row, int i, int j) const {
        if (slab_.weighting == Weighting::Irradiance)
            return constant_;
        const glm::dvec2 s = slab_.s_min_m + glm::dvec2(i, j) * slab_.texel_m();
        const glm::dvec2 from_center = s - slab_.basis_center_m(column, row);
        double sum = 0.0;
        for (int b = 0; b < parts_.y; ++b)
            for (int a = 0; a < parts_.x; ++a)
                sum += over_basis(from_center + (glm::dvec2(a, b) + 0.5) * part_m_);
        return sum * part_m_.x * part_m_.y;
    }

  private:
    // Mean over a part of a texel whose middle is s, relative to the basis function's center.
    double over_basis(glm::dvec2 s) const {
        const double d2 = square(slab_.delta_m);
        const double h2_x = square(part_m_.x), h2_y = square(part_m_.y);
        double sum = 0.0;
        for (std::size_t b = 0; b < u_[1].offset_m.size(); ++b) {
            const double y2 = square(u_[1].offset_m[b] - s.y);
            double line = 0.0;
            for (std::size_t a = 0; a < u_[0].offset_m.size(); ++a) {
                const double x2 = square(u_[0].offset_m[a] - s.x);
                const double inv_r2 = 1.0 / (d2 + x2 + y2);
                const double bend =
                    h2_x * (x2 * inv_r2 - 1.0 / 6.0) + h2_y * (y2 * inv_r2 - 1.0 / 6.0);
                line += u_[0].weight_m[a] * square(inv_r2) * (1.0 + bend * inv_r2);
            }
            sum += u_[1].weight_m[b] * line;
        }
        return sum * d2;
    }

    const Slab& slab_;
    double constant_ = 0.0;
    std::array<Nodes, 2> u_;
    glm::ivec2 parts_{1};
    glm::dvec2 part_m_{0.0};
};

// Sum over the slab's texels of weight * visit's values, images in parallel and added in order.
template <typename OfImage>
auto sum_over_images(const Slab& slab, const OfImage& of_image) {
    std::vector<decltype(of_image(0))> parts(static_cast<std::size_t>(slab.image_count()));
    tbb::parallel_for(std::size_t{0}, parts.size(),
                      [&](std::size_t m) { parts[m] = of_image(static_cast<int>(m)); });
    decltype(of_image(0)) sum{};
    for (const auto& part : parts)
        sum += part;
    return sum;
}

// Calls visit(m, column, row, window_x, window_y) for every image that a receiver sees.
template <typename Visit>
void for_each_image(const Slab& slab,
                    const AxisWindows& x,
                    const AxisWindows& y,
                    const Visit& visit) {
    for (int row = 0; row < slab.grid.y; ++row)
        for (int column = 0; column < slab.grid.x; ++column)
            visit(row * slab.grid.x + column, x.of_basis[static_cast<std::size_t>(column)],
                  y.of_basis[static_cast<std::size_t>(row)]);
}

// Variance of Y of a weighted sum of one slab's coefficients; channels are taken as fully
// correlated (they come from the same photons or rays), which is the upper bound.
template <typename Weight>
double window_variance_y(
    const Slab& slab, int m, TexelRange x, TexelRange y, const Weight& weight) {
    double variance = 0.0;
    for (int j = y.first; j < y.first + y.count; ++j)
        for (int i = x.first; i < x.first + x.count; ++i) {
            double sigma = 0.0;
            for (int c = 0; c < slab.channels; ++c)
                sigma +=
                    (slab.channels == 1 ? 1.0 : kLuminanceRgb[static_cast<std::size_t>(c)]) *
                    static_cast<double>(slab.sigma[slab.image_offset(c, m) +
                                                   static_cast<std::size_t>(j) *
                                                       static_cast<std::size_t>(slab.texels.x) +
                                                   static_cast<std::size_t>(i)]);
            if (sigma > 0.0)
                variance += square(sigma * weight(i, j));
        }
    return variance;
}

// Far away, with the normal -z, the sum is int int C Phi: moments of order zero alone. Radiance
// weighting has no kernel there.
constexpr glm::dvec3 kFacing{0.0, 0.0, -1.0};

Slab without_kernel(const Slab& slab) {
    Slab plain_geometry;
    plain_geometry.texels = slab.texels;
    plain_geometry.channels = slab.channels;
    return plain_geometry;
}

// Of that sum to intensity.
double intensity_scale(const Slab& slab, double cosine) {
    return slab.weighting == Weighting::Irradiance
               ? square(slab.delta_m) / (cosine * cosine * cosine)
               : cosine;
}

glm::dvec3 flux_of(const Slab& slab, const std::vector<float>& coeffs) {
    const TexelFlux texel_flux(slab);
    return sum_over_images(slab, [&](int m) {
        Sums sums{};
        for (int j = 0; j < slab.texels.y; ++j)
            for (int i = 0; i < slab.texels.x; ++i) {
                const auto at =
                    static_cast<std::size_t>(j) * static_cast<std::size_t>(slab.texels.x) +
                    static_cast<std::size_t>(i);
                Sums c{};
                for (int channel = 0; channel < slab.channels; ++channel)
                    c[static_cast<std::size_t>(channel)] =
                        static_cast<double>(coeffs[slab.image_offset(channel, m) + at]);
                if (c == Sums{})
                    continue;
                const double weight = texel_flux(m % slab.grid.x, m / slab.grid.x, i, j);
                for (std::size_t k = 0; k < c.size(); ++k)
                    sums[k] += c[k] * weight;
            }
        return color(slab, sums);
    });
}

glm::dvec3 irradiance_of(const Slab& slab,
                         const std::vector<float>& coeffs,
                         const Receiver& receiver) {
    const glm::dvec3 p = receiver.position_m;
    if (!(p.z > -slab.delta_m))
        return glm::dvec3(0.0);
    const AxisWindows x = make_windows(slab, 0, p.x, p.z);
    const AxisWindows y = make_windows(slab, 1, p.y, p.z);
    Sums sums{};
    const std::size_t stride = slab.image_offset(1, 0);
    for_each_image(slab, x, y, [&](int m, const AxisWindow& wx, const AxisWindow& wy) {
        add_image(slab, coeffs.data() + slab.image_offset(0, m), stride, wx, wy, receiver.normal,
                  sums.data());
    });
    const double scale = slab.weighting == Weighting::Irradiance ? square(slab.delta_m) : 1.0;
    return glm::max(color(slab, sums) * scale, 0.0);
}

glm::dvec3 intensity_of(const Slab& slab, const std::vector<float>& coeffs, glm::dvec3 direction) {
    const double cosine = glm::normalize(direction).z;
    if (!(cosine > 0.0))
        return glm::dvec3(0.0);
    const AxisWindows x = make_far_windows(slab, 0, direction.x / direction.z);
    const AxisWindows y = make_far_windows(slab, 1, direction.y / direction.z);
    Sums sums{};
    const std::size_t stride = slab.image_offset(1, 0);
    const Slab plain_geometry = without_kernel(slab);
    for_each_image(slab, x, y, [&](int m, const AxisWindow& wx, const AxisWindow& wy) {
        add_image(plain_geometry, coeffs.data() + slab.image_offset(0, m), stride, wx, wy, kFacing,
                  sums.data());
    });
    return color(slab, sums) * intensity_scale(slab, cosine);
}

bool has_replicates(const LightField& lightfield) {
    return !lightfield.slabs.empty() && !lightfield.slabs.front().replicates.empty();
}

// About the fit itself, not about their mean: where coefficients may not be negative noise shifts
// them too.
template <typename OfReplicate>
double spread_of_replicates(const LightField& lightfield,
                            double fitted,
                            const OfReplicate& of_replicate) {
    const std::size_t count = lightfield.slabs.front().replicates.size();
    double variance = 0.0;
    for (std::size_t r = 0; r < count; ++r) {
        double sum = 0.0;
        for (const Slab& slab : lightfield.slabs)
            sum += of_replicate(slab, slab.replicates[r]);
        variance += square(sum - fitted) / static_cast<double>(count);
    }
    return std::sqrt(variance);
}

}  // namespace

Receiver to_slab(const Slab& slab, const Receiver& receiver) {
    const glm::dmat3 slab_from_luminaire = glm::transpose(slab.luminaire_from_slab.rotation);
    return {slab_from_luminaire * (receiver.position_m - slab.luminaire_from_slab.translation_m),
            slab_from_luminaire * receiver.normal};
}

double luminance(glm::dvec3 rgb) {
    return kLuminanceRgb[0] * rgb.r + kLuminanceRgb[1] * rgb.g + kLuminanceRgb[2] * rgb.b;
}

glm::dvec3 radiance(const Slab& slab, glm::dvec2 u_m, glm::dvec2 s_m) {
    const glm::dvec2 texel = glm::floor((s_m - slab.s_min_m) / slab.texel_m());
    if (!(texel.x >= 0 && texel.x < slab.texels.x && texel.y >= 0 && texel.y < slab.texels.y))
        return glm::dvec3(0.0);
    const auto offset =
        static_cast<std::size_t>(texel.y) * static_cast<std::size_t>(slab.texels.x) +
        static_cast<std::size_t>(texel.x);
    Sums sums{};
    for (int row = 0; row < slab.grid.y; ++row)
        for (int column = 0; column < slab.grid.x; ++column) {
            const glm::dvec2 x = (u_m - slab.basis_center_m(column, row)) / slab.pitch_m;
            const double basis = eval(slab.profile, x.x) * eval(slab.profile, x.y);
            if (basis == 0.0)
                continue;
            for (int c = 0; c < slab.channels; ++c)
                sums[static_cast<std::size_t>(c)] +=
                    basis *
                    static_cast<double>(
                        slab.coeffs[slab.image_offset(c, row * slab.grid.x + column) + offset]);
        }
    if (slab.weighting == Weighting::Radiance)
        return color(slab, sums);
    // delta^2 / cos^4(theta), cos^2 = delta^2 / r^2
    const double r2 = square(slab.delta_m) + square(u_m.x - s_m.x) + square(u_m.y - s_m.y);
    return color(slab, sums) * (square(r2) / square(slab.delta_m));
}

glm::dvec3 flux(const Slab& slab) {
    return flux_of(slab, slab.coeffs);
}

glm::dvec3 flux(const LightField& lightfield) {
    glm::dvec3 sum(0.0);
    for (const Slab& slab : lightfield.slabs)
        sum += flux(slab);
    return sum;
}

double flux_sigma_y(const LightField& lightfield) {
    if (has_replicates(lightfield))
        return spread_of_replicates(lightfield, luminance(flux(lightfield)),
                                    [](const Slab& slab, const std::vector<float>& coeffs) {
                                        return luminance(flux_of(slab, coeffs));
                                    });
    double variance = 0.0;
    for (const Slab& slab : lightfield.slabs) {
        if (slab.sigma.empty())
            continue;
        const TexelFlux texel_flux(slab);
        variance += sum_over_images(slab, [&](int m) {
            return window_variance_y(
                slab, m, {0, slab.texels.x}, {0, slab.texels.y},
                [&](int i, int j) { return texel_flux(m % slab.grid.x, m / slab.grid.x, i, j); });
        });
    }
    return std::sqrt(variance);
}

glm::dvec3 intensity(const Slab& slab, glm::dvec3 direction) {
    return intensity_of(slab, slab.coeffs, direction);
}

glm::dvec3 intensity(const LightField& lightfield, glm::dvec3 direction) {
    glm::dvec3 sum(0.0);
    for (const Slab& slab : lightfield.slabs)
        sum += intensity(slab, glm::transpose(slab.luminaire_from_slab.rotation) * direction);
    return sum;
}

double intensity_sigma_y(const LightField& lightfield, glm::dvec3 direction) {
    const double fitted = luminance(intensity(lightfield, direction));
    const double common = lightfield.scale_sigma_rel * fitted;
    if (has_replicates(lightfield))
        return std::hypot(
            common,
            spread_of_replicates(
                lightfield, fitted, [&](const Slab& slab, const std::vector<float>& coeffs) {
                    return luminance(intensity_of(
                        slab, coeffs,
                        glm::transpose(slab.luminaire_from_slab.rotation) * direction));
                }));
    double variance = 0.0;
    for (const Slab& slab : lightfield.slabs) {
        const glm::dvec3 d = glm::transpose(slab.luminaire_from_slab.rotation) * direction;
        const double cosine = glm::normalize(d).z;
        if (slab.sigma.empty() || !(cosine > 0.0))
            continue;
        const AxisWindows x = make_far_windows(slab, 0, d.x / d.z);
        const AxisWindows y = make_far_windows(slab, 1, d.y / d.z);
        const Slab plain_geometry = without_kernel(slab);
        for_each_image(slab, x, y, [&](int m, const AxisWindow& wx, const AxisWindow& wy) {
            variance += square(intensity_scale(slab, cosine)) *
                        window_variance_y(slab, m, wx.range, wy.range, [&](int i, int j) {
                            return texel_weight(plain_geometry, wx, wy, kFacing, i, j);
                        });
        });
    }
    return std::sqrt(variance + square(common));
}

glm::dvec3 irradiance(const Slab& slab, const Receiver& receiver) {
    return irradiance_of(slab, slab.coeffs, receiver);
}

glm::dvec3 irradiance(const LightField& lightfield, const Receiver& receiver) {
    glm::dvec3 sum(0.0);
    for (const Slab& slab : lightfield.slabs)
        sum += irradiance(slab, to_slab(slab, receiver));
    return sum;
}

double irradiance_sigma_y(const LightField& lightfield, const Receiver& receiver) {
    const double fitted = luminance(irradiance(lightfield, receiver));
    const double common = lightfield.scale_sigma_rel * fitted;
    if (has_replicates(lightfield))
        return std::hypot(
            common,
            spread_of_replicates(
                lightfield, fitted, [&](const Slab& slab, const std::vector<float>& coeffs) {
                    return luminance(irradiance_of(slab, coeffs, to_slab(slab, receiver)));
                }));
    double variance = 0.0;
    for (const Slab& slab : lightfield.slabs) {
        const Receiver local = to_slab(slab, receiver);
        const glm::dvec3 p = local.position_m;
        if (slab.sigma.empty() || !(p.z > -slab.delta_m))
            continue;
        const AxisWindows x = make_windows(slab, 0, p.x, p.z);
        const AxisWindows y = make_windows(slab, 1, p.y, p.z);
        const double scale = slab.weighting == Weighting::Irradiance ? square(slab.delta_m) : 1.0;
        for_each_image(slab, x, y, [&](int m, const AxisWindow& wx, const AxisWindow& wy) {
            variance +=
                square(scale) * window_variance_y(slab, m, wx.range, wy.range, [&](int i, int j) {
                    return texel_weight(slab, wx, wy, local.normal, i, j);
                });
        });
    }
    return std::sqrt(variance + square(common));
}

}  // namespace nearfield::model
