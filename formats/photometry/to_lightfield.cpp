// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/to_lightfield.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "formats/model/slab_axes.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/lit_box.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

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
    if (options.slabs && *options.slabs != 1 && *options.slabs != 5 && *options.slabs != 6)
        throw Error{"light field of photometry", "slabs", "1, 5 or 6",
                    fmt::format("{}", *options.slabs)};
}

glm::ivec2 counts_for(glm::dvec2 size, int along_longer) {
    const double longer = std::max(size.x, size.y);
    return glm::max(glm::ivec2(1), glm::ivec2(glm::round(double(along_longer) * size / longer)));
}

// Tangent of the widest angle from a slab's axis at which it has a share, of several slabs.
constexpr double kReachOfSeveral = 1.2;

Slab planes_for(const FlatOpening& opening,
                int index,
                double delta_m,
                double reach,
                const LightFieldOptions& options) {
    Slab slab;
    slab.delta_m = delta_m;
    // The first S is the luminaire's z = 0, the box's middle lies delta behind it.
    slab.luminaire_from_slab.rotation = model::axes_from_slab(index);
    slab.luminaire_from_slab.translation_m =
        delta_m * (slab.luminaire_from_slab.rotation[2] - glm::dvec3(0, 0, 1));
    slab.grid = counts_for(opening.size_m, options.cells);
    slab.pitch_m = opening.size_m / glm::dvec2(slab.grid);
    slab.s_max_m = 0.5 * opening.size_m + slab.delta_m * reach;
    slab.s_min_m = -slab.s_max_m;
    slab.texels = counts_for(slab.s_max_m, options.texels);
    slab.profile = model::make_profile("box");
    slab.coeffs.resize(static_cast<std::size_t>(slab.image_count()) * slab.texel_count());
    return slab;
}

// Whether a slab takes light of a direction in the luminaire's frame.
bool is_taken(const glm::dvec3& d, int slab_count, double half_angle_deg) {
    if (slab_count > 1)
        return slab_count == 6 || model::dominant_slab(glm::vec3(d)) < slab_count;
    const double reach = std::tan(half_angle_deg * std::numbers::pi / 180);
    return d.z > 0 && std::abs(d.x) < reach * d.z && std::abs(d.y) < reach * d.z;
}

// Calls visit(direction in the luminaire's frame, flux) for parts of a degree each way.
template <typename Visit>
void for_each_part(const Photometry& photometry, const Visit& visit) {
    const glm::dmat3 photometry_from_luminaire =
        glm::transpose(luminaire_from_photometry(photometry.coordinates));
    constexpr double kRad = std::numbers::pi / 180;
    for (int polar = 0; polar < 180; ++polar)
        for (int around = 0; around < 360; ++around) {
            const double theta = (polar + 0.5) * kRad, phi = (around + 0.5) * kRad;
            const glm::dvec3 d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                               std::cos(theta));
            visit(d, intensity_cd(photometry, photometry_from_luminaire * d) * std::sin(theta) *
                         kRad * kRad);
        }
}

// The fewest that lose less than this.
constexpr double kMostLost = 0.01;

int choose_slabs(const Photometry& photometry, double half_angle_deg) {
    double whole = 0, by_one = 0, by_five = 0;
    for_each_part(photometry, [&](const glm::dvec3& d, double flux) {
        whole += flux;
        by_one += is_taken(d, 1, half_angle_deg) ? flux : 0;
        by_five += is_taken(d, 5, half_angle_deg) ? flux : 0;
    });
    return by_one >= (1 - kMostLost) * whole ? 1 : by_five >= (1 - kMostLost) * whole ? 5 : 6;
}

// Mean over a texel of I cos^3(theta), seen from u.
class TexelMean {
  public:
    TexelMean(const Photometry& photometry, const Slab& slab, int index, int slab_count)
        : photometry_(photometry),
          slab_(slab),
          photometry_from_luminaire_(
              glm::transpose(luminaire_from_photometry(photometry.coordinates))),
          index_(static_cast<std::size_t>(index)),
          slab_count_(slab_count) {}

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
        const glm::dvec3 d_luminaire = slab_.luminaire_from_slab.rotation * d;
        const auto share =
            static_cast<double>(model::slab_shares(glm::vec3(d_luminaire), slab_count_)[index_]);
        if (share == 0)
            return 0;
        return share * intensity_cd(photometry_, photometry_from_luminaire_ * d_luminaire) * d.z *
               d.z * d.z;
    }

    const Photometry& photometry_;
    const Slab& slab_;
    glm::dmat3 photometry_from_luminaire_;
    std::size_t index_;
    int slab_count_;
};

void fill_slab(Slab& slab, const FlatOpening& opening, const TexelMean& texel_mean) {
    const double scale = 1 / (opening.area_m2() * slab.delta_m * slab.delta_m);
    const int rows = slab.image_count() * slab.texels.y;
    tbb::parallel_for(0, rows, [&](int k) {
        const int m = k / slab.texels.y, j = k % slab.texels.y;
        const int column = m % slab.grid.x, row = m / slab.grid.x;
        const double covered = coverage(opening, slab, column, row);
        std::size_t at = slab.image_offset(0, m) +
                         static_cast<std::size_t>(j) * static_cast<std::size_t>(slab.texels.x);
        for (int i = 0; i < slab.texels.x; ++i)
            slab.coeffs[at++] = static_cast<float>(
                covered * scale * texel_mean(slab.basis_center_m(column, row), i, j));
    });
}

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
    const LitBox box = lit_box(photometry, options.opening_m);
    const int slab_count = options.slabs.value_or(choose_slabs(photometry, options.half_angle_deg));
    const double reach = slab_count == 1 ? std::tan(options.half_angle_deg * std::numbers::pi / 180)
                                         : kReachOfSeveral;
    const double delta_m = options.delta_sides * std::max(box.size_m.x, box.size_m.y);
    FarLightField result;
    for (int s = 0; s < slab_count; ++s) {
        const FlatOpening side = side_of(box, s);
        Slab slab = planes_for(side, s, delta_m, reach, options);
        fill_slab(slab, side, TexelMean(photometry, slab, s, slab_count));
        result.lightfield.slabs.push_back(std::move(slab));
    }
    result.photometry_lm = flux_lm(photometry);
    result.lightfield_lm = model::luminance(model::flux(result.lightfield));
    for_each_part(photometry, [&](const glm::dvec3& d, double flux) {
        if (!(flux > 0) || is_taken(d, slab_count, options.half_angle_deg))
            return;
        const double angle_deg = std::acos(d.z) * 180 / std::numbers::pi;
        result.least_lost_deg = std::min(result.least_lost_deg, angle_deg);
        result.most_lost_deg = std::max(result.most_lost_deg, angle_deg);
    });
    nearfield::check(result.lightfield, "light field of photometry");
    return result;
}

}  // namespace nearfield::photometry
