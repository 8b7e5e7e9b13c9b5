// SPDX-License-Identifier: Apache-2.0
#include "tests/support/lamps.h"

#include "formats/model/profile.h"
#include "tests/support/random.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace nearfield::support {
namespace {

constexpr glm::ivec2 kReferenceGrid{11, 9};
constexpr int kReferenceTexels = 256;
constexpr double kReferenceDeltaM = 0.2;
constexpr double kReferenceHalfSizeM = 0.25;
constexpr double kReferencePitchM = 0.0165;

/// Radiance of the reference lamp from u towards s, cd/m^2 in an arbitrary scale.
double reference_radiance(glm::dvec2 u_m, glm::dvec2 s_m) {
    if (!(std::hypot(u_m.x, 1.1 * u_m.y) < 0.085))  // outside the lens
        return 0.0;
    const glm::dvec2 slope = (s_m - u_m) / kReferenceDeltaM;
    const double facet_column = std::floor((u_m.x + 0.1) / 0.018);
    const double facet_row = std::floor((u_m.y + 0.08) / 0.016);
    const glm::dvec2 beam(0.25 * std::sin(1.7 * facet_column + 0.3 * facet_row),
                          -0.05 + 0.04 * std::cos(2.3 * facet_row + facet_column));
    const auto square = [](double x) { return x * x; };
    const double facet =
        40.0 * std::exp(-square((slope.x - beam.x) / 0.05) - square((slope.y - beam.y) / 0.03));
    const double spread = 3.0 * std::exp(-square(slope.x) / 0.1 - square(slope.y + 0.08) / 0.01);
    const double cutoff_slope = slope.x > 0.0 ? 0.02 : 0.0;
    const double below_cutoff = 1.0 / (1.0 + std::exp((slope.y - cutoff_slope) / 0.004));
    return (facet + spread) * below_cutoff + 0.005;
}

Slab reference_geometry() {
    Slab slab;
    slab.delta_m = kReferenceDeltaM;
    slab.grid = kReferenceGrid;
    slab.pitch_m = glm::dvec2(kReferencePitchM);
    slab.texels = glm::ivec2(kReferenceTexels);
    slab.s_min_m = glm::dvec2(-kReferenceHalfSizeM);
    slab.s_max_m = glm::dvec2(kReferenceHalfSizeM);
    slab.profile = model::make_profile("bspline");
    return slab;
}

}  // namespace

Profile measured_profile() {
    // Non-negative on each cell, with jumps between cells; x runs from -2 to 2.
    return {"measured",
            {{0.9, 0.85, 0.21}, {0.8, 0.35, 0.1}, {0.85, -0.05, -0.3}, {1.3, -1.1, 0.24}}};
}

std::vector<Profile> all_profiles() {
    std::vector<Profile> profiles;
    for (const std::string& name : model::profile_names())
        profiles.push_back(model::make_profile(name));
    profiles.push_back(measured_profile());
    return profiles;
}

Slab random_lamp(const Profile& profile,
                 Weighting weighting,
                 std::uint64_t seed,
                 const LampShape& shape) {
    Slab slab;
    slab.delta_m = shape.delta_m;
    slab.grid = shape.grid;
    slab.pitch_m = shape.pitch_m;
    slab.u_center_m = shape.u_center_m;
    slab.texels = shape.texels;
    slab.s_min_m = shape.s_min_m;
    slab.s_max_m = shape.s_max_m;
    slab.profile = profile;
    slab.weighting = weighting;
    slab.channels = shape.channels;
    Random random{seed};
    slab.coeffs.resize(slab.image_offset(shape.channels, 0));
    for (float& c : slab.coeffs) {
        const double exponent = 2.0 - shape.decades * random.uniform();
        const bool dark = random.uniform() < shape.dark_fraction;
        c = dark ? 0.0F : static_cast<float>(std::pow(10.0, exponent));
    }
    return slab;
}

Slab scaled_lamp(const Slab& slab, double factor) {
    Slab scaled = slab;
    scaled.luminaire_from_slab.translation_m *= factor;
    scaled.delta_m *= factor;
    scaled.pitch_m *= factor;
    scaled.u_center_m *= factor;
    scaled.s_min_m *= factor;
    scaled.s_max_m *= factor;
    // L = delta^2 / cos^4 sum C Phi: C takes back what delta^2 gained.
    if (slab.weighting == Weighting::Irradiance)
        for (float& c : scaled.coeffs)
            c = static_cast<float>(c / (factor * factor));
    return scaled;
}

glm::dmat3 rotation_about(glm::dvec3 axis, double angle_rad) {
    // Rodrigues: v cos + (a x v) sin + a (a.v) (1 - cos), applied to the unit vectors.
    glm::dmat3 rotation(0.0);
    for (int k = 0; k < 3; ++k) {
        glm::dvec3 v(0.0);
        v[k] = 1.0;
        rotation[k] = v * std::cos(angle_rad) + glm::cross(axis, v) * std::sin(angle_rad) +
                      axis * (glm::dot(axis, v) * (1.0 - std::cos(angle_rad)));
    }
    return rotation;
}

std::vector<double> reference_lamp_coeffs() {
    const Slab slab = reference_geometry();
    std::vector<double> coeffs(slab.image_offset(1, 0));
    tbb::parallel_for(0, slab.image_count(), [&](int m) {
        const glm::dvec2 u_m = slab.basis_center_m(m % slab.grid.x, m / slab.grid.x);
        std::size_t at = slab.image_offset(0, m);
        for (int j = 0; j < slab.texels.y; ++j)
            for (int i = 0; i < slab.texels.x; ++i, ++at) {
                const glm::dvec2 s_m = slab.s_min_m + slab.texel_m() * (glm::dvec2(i, j) + 0.5);
                const glm::dvec2 across_m = s_m - u_m;
                const double delta2_m2 = slab.delta_m * slab.delta_m;
                const double cosine2 = delta2_m2 / (glm::dot(across_m, across_m) + delta2_m2);
                coeffs[at] = reference_radiance(u_m, s_m) * cosine2 * cosine2 / delta2_m2;
            }
    });
    return coeffs;
}

Slab reference_lamp() {
    Slab slab = reference_geometry();
    for (const double c : reference_lamp_coeffs())
        slab.coeffs.push_back(static_cast<float>(c));
    return slab;
}

std::vector<model::Receiver> reference_receivers() {
    constexpr double kTwoPi = 6.283185307179586;
    Random random{1};
    std::vector<model::Receiver> receivers(300);
    for (model::Receiver& receiver : receivers) {
        const double x = random.uniform(), y = random.uniform(), z = random.uniform();
        receiver.position_m = {(x - 0.5) * 4.0, (y - 0.5) - 0.2, 0.5 + 6.0 * z};
        const double cosine = 0.5 + 0.5 * random.uniform();
        const double azimuth_rad = kTwoPi * random.uniform();
        const double sine = std::sqrt(1.0 - cosine * cosine);
        receiver.normal = {sine * std::cos(azimuth_rad), sine * std::sin(azimuth_rad), -cosine};
    }
    return receivers;
}

}  // namespace nearfield::support
