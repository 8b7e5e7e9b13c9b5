// SPDX-License-Identifier: Apache-2.0
#include "sample_data/headlight.h"

#include "formats/model/profile.h"
#include "sample_data/random.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::sample_data {
namespace {

constexpr double kFlux_lm = 1000.0;
constexpr glm::dvec2 kFacet_m{0.032, 0.026};
constexpr glm::ivec2 kFacetCount{5, 5};  // over the ellipse's bounding box

// The kink: 15 degrees on the aiming wall, as ECE R112 draws it; the rise ends 10 degrees to the
// right.
constexpr double kKinkSlope = 0.26794919243112270;  // tan(15 deg)
constexpr double kKinkEnd = 0.18;

// A part of the beam: center and half-widths in tangents, relative luminance, share of the facets.
struct Role {
    glm::dvec2 center, half;
    double peak, share;
};
constexpr std::array<Role, 3> kRoles = {{
    {{0.012, -0.026}, {0.105, 0.034}, 1.00, 0.40},  // hot spot
    {{0.000, -0.050}, {0.280, 0.060}, 0.34, 0.35},  // spread
    {{0.000, -0.100}, {0.380, 0.090}, 0.26, 0.25},  // foreground
}};
// Largest steering of a facet's beam, in half-widths of its role, and largest deviation of its
// gain.
constexpr glm::dvec2 kSteer{0.60, 0.15};
constexpr double kGainSpread = 0.25;

// Cut-off by channel in tangents. A lens that is sharp in green blurs blue most: blue light above
// the line, its lack (yellow-red) below. 10-90 % width is 0.61 of the step's: 0.15, 0.20 and 0.37
// degrees.
constexpr std::array<double, 3> kStepWidth = {0.0044, 0.0058, 0.0105};
constexpr std::array<double, 3> kStepCenter = {-0.0004, 0.0, 0.0008};

// A white LED of about 5500 K, linear Rec.709, Y = 1.
constexpr std::array<double, 3> kColor = {1.02, 1.0, 0.9411};
// Scattered light relative to the hot spot's peak: some 100 cd above the cut-off; slightly blue.
constexpr std::array<double, 3> kStray = {0.0010, 0.0011, 0.0014};
// Widths over which the beam's window fades: sides, top, bottom, tangents.
constexpr double kFadeSide = 0.12, kFadeTop = 0.016, kFadeBottom = 0.060;
// Scattered light fades upwards from the cut-off on.
constexpr double kFadeStray = 0.070;

double limit(double x, double lower, double upper) {
    const double raised = x < lower ? lower : x;
    return raised > upper ? upper : raised;
}

// 0 at x <= 0, 1 at x >= 1, twice differentiable between.
double smooth_step(double x) {
    const double t = limit(x, 0.0, 1.0);
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

double bell(double z) {
    const double q = 1.0 + z * z;
    return 1.0 / (q * q);
}

int facet_index(glm::dvec2 u_m) {
    const glm::dvec2 cell = (u_m + 0.5 * kFacet_m * glm::dvec2(kFacetCount)) / kFacet_m;
    const int column = std::clamp(static_cast<int>(cell.x), 0, kFacetCount.x - 1);
    const int row = std::clamp(static_cast<int>(cell.y), 0, kFacetCount.y - 1);
    return row * kFacetCount.x + column;
}

// Spacing of lens nodes that resolves the cut-off for a receiver at this distance, and each facet
// at least.
glm::dvec2 node_spacing_m(double distance_m) {
    const double step_m = 0.25 * kStepWidth[0] * distance_m;
    return {std::clamp(4.0 * step_m, 0.0005, 0.004), std::clamp(step_m, 0.0001, 0.003)};
}

// Integral over the lens of weight(u) * L(u, t(u)), u in metres.
template <typename DirectionAndWeight>
glm::dvec3 integrate_lens(const Headlight& headlight,
                          glm::dvec2 spacing_m,
                          const DirectionAndWeight& direction_and_weight) {
    glm::dvec3 sum(0.0);
    for (const ApertureRow& row : aperture_rows(headlight_aperture(), spacing_m)) {
        for (const Node& x : row.x) {
            const glm::dvec2 u_m(x.at_m, row.y.at_m);
            const glm::dvec3 tangent_and_weight = direction_and_weight(u_m);
            if (tangent_and_weight.z > 0.0) {
                sum += tangent_and_weight.z * x.weight_m * row.y.weight_m *
                       radiance(headlight, u_m, glm::dvec2(tangent_and_weight));
            }
        }
    }
    return sum;
}

// Integral of L cos^4 over a product of tangents, through one point of the lens: lm/m^2.
glm::dvec3 flux_per_area(const Headlight& headlight,
                         glm::dvec2 u_m,
                         const std::vector<Node>& tangents_x,
                         const std::vector<Node>& tangents_y) {
    const std::size_t count = tangents_x.size();
    std::vector<double> x(count), rgb(3 * count);
    std::transform(tangents_x.begin(), tangents_x.end(), x.begin(),
                   [](const Node& node) { return node.at_m; });
    glm::dvec3 sum(0.0);
    for (const Node& t_y : tangents_y) {
        radiance_row(headlight, u_m, t_y.at_m, x, rgb);
        for (std::size_t i = 0; i < count; ++i) {
            const double q = 1.0 + x[i] * x[i] + t_y.at_m * t_y.at_m;
            sum += t_y.weight_m * tangents_x[i].weight_m / (q * q) *
                   glm::dvec3(rgb[i], rgb[count + i], rgb[2 * count + i]);
        }
    }
    return sum;
}

}  // namespace

Headlight make_headlight(std::uint64_t seed) {
    Headlight headlight;
    SplitMix random{seed};
    for (int k = 0; k < kFacetCount.x * kFacetCount.y; ++k) {
        Facet facet;
        const double pick = random.next();
        facet.role = pick < kRoles[0].share ? 0 : pick < kRoles[0].share + kRoles[1].share ? 1 : 2;
        const Role& role = kRoles[static_cast<std::size_t>(facet.role)];
        facet.steer.x = (2.0 * random.next() - 1.0) * kSteer.x * role.half.x;
        facet.steer.y = (2.0 * random.next() - 1.0) * kSteer.y * role.half.y;
        facet.gain = 1.0 + kGainSpread * (2.0 * random.next() - 1.0);
        headlight.facets.push_back(facet);
    }
    headlight.scale_cd_m2 = kFlux_lm / model::luminance(flux(headlight));
    return headlight;
}

void radiance_row(const Headlight& headlight,
                  glm::dvec2 u_m,
                  double tangent_y,
                  std::span<const double> tangent_x,
                  std::span<double> rgb) {
    const std::size_t count = tangent_x.size();
    const glm::dvec2 on_lens = u_m / kLensHalf_m;
    const double y = tangent_y + u_m.y / kFocus_m;
    const double window_y =
        smooth_step((kBeamMax.y - y) / kFadeTop) * smooth_step((y - kBeamMin.y) / kFadeBottom);
    if (glm::dot(on_lens, on_lens) > 1.0 || window_y <= 0.0) {
        std::fill(rgb.begin(), rgb.end(), 0.0);
        return;
    }
    const Facet& facet = headlight.facets[static_cast<std::size_t>(facet_index(u_m))];
    const Role& role = kRoles[static_cast<std::size_t>(facet.role)];
    const glm::dvec2 center = role.center + facet.steer;
    const double inverse_half_x = 1.0 / role.half.x;
    const double part = facet.gain * role.peak * bell((y - center.y) / role.half.y);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double beam = part * kColor[channel];
        const double stray = kStray[channel] * smooth_step((kBeamMax.y - y) / kFadeStray);
        const double scale = headlight.scale_cd_m2 * window_y;
        const double inverse_width = 1.0 / kStepWidth[channel];
        const double step_top = kStepCenter[channel] + 0.5 * kStepWidth[channel];
        double* const out = rgb.data() + channel * count;
        for (std::size_t i = 0; i < count; ++i) {
            const double x = -(tangent_x[i] + u_m.x / kFocus_m);
            const double y_cut = kCutoffTangent + kKinkSlope * limit(x, 0.0, kKinkEnd);
            const double below = smooth_step((y_cut + step_top - y) * inverse_width);
            const double window_x = smooth_step((kBeamMax.x - std::abs(x)) / kFadeSide);
            out[i] =
                scale * window_x * (beam * bell((x - center.x) * inverse_half_x) * below + stray);
        }
    }
}

glm::dvec3 radiance(const Headlight& headlight, glm::dvec2 u_m, glm::dvec2 tangent) {
    std::array<double, 3> rgb{};
    radiance_row(headlight, u_m, tangent.y, std::span(&tangent.x, 1), rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

glm::dvec3 flux(const Headlight& headlight) {
    // Directions: the window and its shift by u / F, on a grid finer than the cut-off; dw = cos^3
    // dt, cosine once more.
    const glm::dvec2 shift = kLensHalf_m / kFocus_m;
    const std::vector<Node> tangents_y =
        gauss_nodes(kBeamMin.y - shift.y, kBeamMax.y + shift.y, {}, 0.25 * kStepWidth[0]);
    const std::vector<Node> tangents_x =
        gauss_nodes(kBeamMin.x - shift.x, kBeamMax.x + shift.x, {0.0}, 0.01);
    const std::vector<ApertureRow> rows = aperture_rows(headlight_aperture(), kFacet_m);
    std::vector<glm::dvec3> row_sums(rows.size(), glm::dvec3(0.0));
    tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t r) {
        for (const Node& u_x : rows[r].x) {
            row_sums[r] +=
                rows[r].y.weight_m * u_x.weight_m *
                flux_per_area(headlight, {u_x.at_m, rows[r].y.at_m}, tangents_x, tangents_y);
        }
    });
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& row_sum : row_sums) {
        sum += row_sum;
    }
    return sum;
}

glm::dvec3 intensity(const Headlight& headlight, glm::dvec3 direction) {
    const glm::dvec3 unit = glm::normalize(direction);
    if (unit.z <= 0.0) {
        return glm::dvec3(0.0);
    }
    const glm::dvec3 tangent_and_cosine(unit.x / unit.z, unit.y / unit.z, unit.z);
    return integrate_lens(headlight, node_spacing_m(kFocus_m),
                          [&](glm::dvec2) { return tangent_and_cosine; });
}

glm::dvec3 irradiance(const Headlight& headlight, const model::Receiver& receiver_lens) {
    const glm::dvec3 p_m = receiver_lens.position_m;
    if (p_m.z <= 0.0) {
        return glm::dvec3(0.0);
    }
    return integrate_lens(headlight, node_spacing_m(p_m.z), [&](glm::dvec2 u_m) {
        const glm::dvec3 to_lens_m = glm::dvec3(u_m, 0.0) - p_m;
        const double square_m2 = glm::dot(to_lens_m, to_lens_m);
        // cos(lens) * cos(receiver) / R^2
        const double weight =
            p_m.z * glm::dot(receiver_lens.normal, to_lens_m) / (square_m2 * square_m2);
        return glm::dvec3(-to_lens_m.x / p_m.z, -to_lens_m.y / p_m.z, weight);
    });
}

Aperture headlight_aperture() {
    Aperture aperture;
    aperture.half_m = kLensHalf_m;
    aperture.is_ellipse = true;
    for (int k = 1; k < kFacetCount.x; ++k) {
        const double x_m = (k - 0.5 * kFacetCount.x) * kFacet_m.x;
        aperture.breaks_x_m.push_back(x_m);
        // Where the rim crosses a vertical edge, a line's integral has a kink.
        const double x = x_m / kLensHalf_m.x;
        const double on_rim_m = kLensHalf_m.y * std::sqrt(1.0 - x * x);
        aperture.breaks_y_m.insert(aperture.breaks_y_m.end(), {-on_rim_m, on_rim_m});
    }
    for (int k = 1; k < kFacetCount.y; ++k) {
        aperture.breaks_y_m.push_back((k - 0.5 * kFacetCount.y) * kFacet_m.y);
    }
    return aperture;
}

Source headlight_source(const Headlight& headlight, double delta_m) {
    Source source;
    source.aperture = headlight_aperture();
    source.radiance_row = [headlight, delta_m](glm::dvec2 u_m, double s_y_m,
                                               std::span<const double> s_x_m,
                                               std::span<double> rgb) {
        thread_local std::vector<double> tangent_x;
        tangent_x.resize(s_x_m.size());
        std::transform(s_x_m.begin(), s_x_m.end(), tangent_x.begin(),
                       [&](double s_m) { return (s_m - u_m.x) / delta_m; });
        radiance_row(headlight, u_m, (s_y_m - u_m.y) / delta_m, tangent_x, rgb);
    };
    return source;
}

Slab headlight_planes(double delta_m,
                      glm::ivec2 grid,
                      glm::ivec2 texels,
                      const std::string& basis,
                      Weighting weighting,
                      int channels) {
    Slab slab;
    slab.delta_m = delta_m;
    slab.grid = grid;
    slab.texels = texels;
    slab.profile = model::make_profile(basis);
    slab.weighting = weighting;
    slab.channels = channels;
    // The outermost centers lie on the rim (box: half a pitch inside), so that the lens is covered
    // and little more.
    const int overhang = static_cast<int>(slab.profile.cells.size()) / 2;
    slab.pitch_m = 2.0 * kLensHalf_m / glm::dvec2(glm::max(grid - overhang, glm::ivec2(1)));
    const glm::dvec2 near_lens = (1.0 - delta_m / kFocus_m) * kLensHalf_m;
    slab.s_min_m = delta_m * kBeamMin - glm::abs(near_lens);
    slab.s_max_m = delta_m * kBeamMax + glm::abs(near_lens);
    return slab;
}

}  // namespace nearfield::sample_data
