// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/to_lightfield.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "formats/photometry/intensity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace nearfield::photometry {
namespace {

void check_options(const LightFieldOptions& options) {
    const auto within = [](const char* name, double value, double least, double most) {
        if (!(value >= least && value <= most))
            throw Error{"light field of photometry", name, fmt::format("{} ... {}", least, most),
                        fmt::format("{}", value)};
    };
    within("half_angle_deg", options.half_angle_deg, 1, 85);
    within("delta_sides", options.delta_sides, 1, 1e6);
    within("cells", options.cells, 1, 64);
    within("texels", options.texels, 8, 4096);
    within("opening_m.x", options.opening_m.x, 0, 1000);
    within("opening_m.y", options.opening_m.y, 0, 1000);
}

// The opening as the beam's axis sees it.
struct FlatOpening {
    glm::dvec2 size_m{0.0};
    bool is_round = false;

    double area_m2() const { return size_m.x * size_m.y * (is_round ? std::numbers::pi / 4 : 1); }
};

FlatOpening flat_opening(const Photometry& photometry, glm::dvec2 asked_m) {
    const glm::dmat3 turn = luminaire_from_photometry(photometry.coordinates);
    const glm::dvec3 size_m = glm::abs(turn * photometry.opening.size_m);
    FlatOpening opening;
    opening.size_m = asked_m.x > 0 && asked_m.y > 0 ? asked_m : glm::dvec2(size_m);
    const Shape round_seen_so =
        photometry.coordinates == Coordinates::A ? Shape::UprightEllipse : Shape::Ellipse;
    opening.is_round =
        photometry.opening.shape == Shape::Ellipsoid || photometry.opening.shape == round_seen_so;
    if (!(opening.area_m2() > 0))
        throw Error{"light field of photometry", "luminous opening",
                    "an area, or a size asked for: light leaves from somewhere",
                    fmt::format("{} m x {} m", opening.size_m.x, opening.size_m.y)};
    return opening;
}

// Area of the quarter 0 ... x, 0 ... y of a disk of radius 1 about 0.
double quarter_area(double x, double y) {
    x = std::min(x, 1.0);
    y = std::min(y, 1.0);
    // Up to where the circle falls below y the height is y, from there sqrt(1 - x^2).
    const auto under_circle = [](double to) {
        return 0.5 * (to * std::sqrt(1 - to * to) + std::asin(to));
    };
    const double corner = std::min(x, std::sqrt(1 - y * y));
    return corner * y + under_circle(x) - under_circle(corner);
}

// The same of a rectangle lo ... hi, which may lie anywhere.
double disk_area(glm::dvec2 lo, glm::dvec2 hi) {
    const auto signed_area = [](double x, double y) {
        return std::copysign(1.0, x) * std::copysign(1.0, y) *
               quarter_area(std::abs(x), std::abs(y));
    };
    return signed_area(hi.x, hi.y) - signed_area(lo.x, hi.y) - signed_area(hi.x, lo.y) +
           signed_area(lo.x, lo.y);
}

// How much of a cell of U the opening covers.
double coverage(const FlatOpening& opening, const Slab& slab, int column, int row) {
    if (!opening.is_round)
        return 1;
    const glm::dvec2 radius_m = 0.5 * opening.size_m;
    const glm::dvec2 center_m = slab.basis_center_m(column, row);
    const double area = disk_area((center_m - 0.5 * slab.pitch_m) / radius_m,
                                  (center_m + 0.5 * slab.pitch_m) / radius_m);
    return std::clamp(area * radius_m.x * radius_m.y / (slab.pitch_m.x * slab.pitch_m.y), 0.0, 1.0);
}

glm::ivec2 counts_for(glm::dvec2 size, int along_longer) {
    const double longer = std::max(size.x, size.y);
    return glm::max(glm::ivec2(1), glm::ivec2(glm::round(double(along_longer) * size / longer)));
}

Slab planes_for(const FlatOpening& opening, const LightFieldOptions& options) {
    Slab slab;
    slab.delta_m = options.delta_sides * std::max(opening.size_m.x, opening.size_m.y);
    // S is the luminaire's z = 0, the opening lies behind it.
    slab.grid = counts_for(opening.size_m, options.cells);
    slab.pitch_m = opening.size_m / glm::dvec2(slab.grid);
    const double reach_m = slab.delta_m * std::tan(options.half_angle_deg * std::numbers::pi / 180);
    slab.s_max_m = 0.5 * opening.size_m + reach_m;
    slab.s_min_m = -slab.s_max_m;
    slab.texels = counts_for(slab.s_max_m, options.texels);
    slab.profile = model::make_profile("box");
    slab.coeffs.resize(static_cast<std::size_t>(slab.image_count()) * slab.texel_count());
    return slab;
}

// Mean over a texel of I cos^3(theta), seen from u.
class TexelMean {
  public:
    TexelMean(const Photometry& photometry, const Slab& slab)
        : photometry_(photometry),
          slab_(slab),
          photometry_from_luminaire_(
              glm::transpose(luminaire_from_photometry(photometry.coordinates))) {}

    double operator()(glm::dvec2 u_m, int i, int j) const {
        // Gauss-Legendre of 3 nodes on -1/2 ... 1/2.
        static constexpr double kOuter = 0.3872983346207417;  // sqrt(0.6) / 2
        static constexpr std::array<double, 3> kNodes = {-kOuter, 0, kOuter};
        static constexpr std::array<double, 3> kWeights = {5.0 / 18, 8.0 / 18, 5.0 / 18};
        const glm::dvec2 center_m = slab_.s_min_m + (glm::dvec2(i, j) + 0.5) * slab_.texel_m();
        double mean = 0;
        for (std::size_t a = 0; a < 3; ++a)
            for (std::size_t b = 0; b < 3; ++b) {
                const glm::dvec2 s_m =
                    center_m + glm::dvec2(kNodes[a], kNodes[b]) * slab_.texel_m();
                mean += kWeights[a] * kWeights[b] * value(s_m - u_m);
            }
        return mean;
    }

  private:
    double value(glm::dvec2 across_m) const {
        const glm::dvec3 d = glm::normalize(glm::dvec3(across_m, slab_.delta_m));
        return intensity_cd(photometry_, photometry_from_luminaire_ * d) * d.z * d.z * d.z;
    }

    const Photometry& photometry_;
    const Slab& slab_;
    glm::dmat3 photometry_from_luminaire_;
};

}  // namespace

glm::dmat3 luminaire_from_photometry(Coordinates coordinates) {
    if (coordinates != Coordinates::A)
        return glm::dmat3(1.0);
    // Columns: where the photometry's x (forward), y (right) and z (down) go.
    return {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}};
}

FarLightField to_lightfield(const Photometry& photometry, const LightFieldOptions& options) {
    check(photometry, "photometry");
    check_options(options);
    const FlatOpening opening = flat_opening(photometry, options.opening_m);
    Slab slab = planes_for(opening, options);
    const TexelMean texel_mean(photometry, slab);
    const double scale = 1 / (opening.area_m2() * slab.delta_m * slab.delta_m);
    for (int m = 0; m < slab.image_count(); ++m) {
        const int column = m % slab.grid.x, row = m / slab.grid.x;
        const double covered = coverage(opening, slab, column, row);
        std::size_t at = slab.image_offset(0, m);
        for (int j = 0; j < slab.texels.y; ++j)
            for (int i = 0; i < slab.texels.x; ++i)
                slab.coeffs[at++] = static_cast<float>(
                    covered * scale * texel_mean(slab.basis_center_m(column, row), i, j));
    }
    FarLightField result;
    result.lightfield.slabs.push_back(std::move(slab));
    result.photometry_lm = flux_lm(photometry);
    result.lightfield_lm = model::luminance(model::flux(result.lightfield));
    result.lightfield.provenance = {
        program_version(),
        "photometry",
        {},
        {},
        {{"photometry_lm", result.photometry_lm}, {"lightfield_lm", result.lightfield_lm}}};
    nearfield::check(result.lightfield, "light field of photometry");
    return result;
}

}  // namespace nearfield::photometry
