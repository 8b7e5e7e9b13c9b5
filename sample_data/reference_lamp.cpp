// SPDX-License-Identifier: Apache-2.0
#include "sample_data/reference_lamp.h"

#include "formats/model/profile.h"
#include "sample_data/random.h"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <cmath>

namespace nearfield::sample_data {
namespace {

constexpr double kDelta_m = 0.2, kPitch_m = 0.0165, kHalfExtent_m = 0.25;
constexpr int kTexels = 256;
constexpr int kReceivers = 300;

Slab reference_planes() {
    Slab slab;
    slab.delta_m = kDelta_m;
    slab.grid = {11, 9};
    slab.pitch_m = glm::dvec2(kPitch_m);
    slab.texels = glm::ivec2(kTexels);
    slab.s_min_m = glm::dvec2(-kHalfExtent_m);
    slab.s_max_m = glm::dvec2(kHalfExtent_m);
    slab.profile = model::make_profile("bspline");
    return slab;
}

double square(double x) {
    return x * x;
}

}  // namespace

double reference_radiance(glm::dvec2 u_m, glm::dvec2 s_m) {
    if (std::hypot(u_m.x, u_m.y * 1.1) >= 0.085) {
        return 0.0;
    }
    const glm::dvec2 t = (s_m - u_m) / kDelta_m;
    const double facet_x = std::floor((u_m.x + 0.1) / 0.018);
    const double facet_y = std::floor((u_m.y + 0.08) / 0.016);
    const glm::dvec2 aim(0.25 * std::sin(1.7 * facet_x + 0.3 * facet_y),
                         -0.05 + 0.04 * std::cos(2.3 * facet_y + facet_x));
    const double beam =
        40.0 * std::exp(-square((t.x - aim.x) / 0.05) - square((t.y - aim.y) / 0.03));
    const double spread = 3.0 * std::exp(-square(t.x) / 0.1 - square(t.y + 0.08) / 0.01);
    const double cut_off = 1.0 / (1.0 + std::exp((t.y - (t.x > 0.0 ? 0.02 : 0.0)) / 0.004));
    return (beam + spread) * cut_off + 0.005;
}

std::vector<double> reference_coeffs() {
    const Slab planes = reference_planes();
    std::vector<double> coeffs;
    coeffs.reserve(static_cast<std::size_t>(planes.image_count()) * planes.texel_count());
    for (int m = 0; m < planes.image_count(); ++m) {
        const glm::dvec2 u_m = planes.basis_center_m(m % planes.grid.x, m / planes.grid.x);
        for (int j = 0; j < kTexels; ++j) {
            for (int i = 0; i < kTexels; ++i) {
                const glm::dvec2 s_m = planes.s_min_m + (glm::dvec2(i, j) + 0.5) * planes.texel_m();
                const glm::dvec2 offset_m = s_m - u_m;
                const double square_m2 = glm::dot(offset_m, offset_m) + kDelta_m * kDelta_m;
                coeffs.push_back(reference_radiance(u_m, s_m) *
                                 square(kDelta_m * kDelta_m / square_m2) / (kDelta_m * kDelta_m));
            }
        }
    }
    return coeffs;
}

LightField make_reference_lamp() {
    LightField lightfield;
    lightfield.slabs.push_back(reference_planes());
    const std::vector<double> exact = reference_coeffs();
    std::vector<float>& coeffs = lightfield.slabs.front().coeffs;
    coeffs.resize(exact.size());
    std::transform(exact.begin(), exact.end(), coeffs.begin(),
                   [](double value) { return static_cast<float>(value); });
    return lightfield;
}

std::vector<model::Receiver> reference_receivers() {
    SplitMix random{1};
    std::vector<model::Receiver> receivers(kReceivers);
    for (model::Receiver& receiver : receivers) {
        receiver.position_m.x = (random.next() - 0.5) * 4.0;
        receiver.position_m.y = (random.next() - 0.5) - 0.2;
        receiver.position_m.z = 0.5 + 6.0 * random.next();
        const double cosine = 0.5 + 0.5 * random.next();
        const double angle_rad = glm::two_pi<double>() * random.next();
        const double sine = std::sqrt(1.0 - cosine * cosine);
        receiver.normal = {sine * std::cos(angle_rad), sine * std::sin(angle_rad), -cosine};
    }
    return receivers;
}

}  // namespace nearfield::sample_data
