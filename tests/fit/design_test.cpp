// SPDX-License-Identifier: Apache-2.0
// G against integrals taken another way. What is not tested here: that a real filter is what its
// profile says.
#include "fit/design.h"

#include "formats/files/error.h"
#include "tests/fit/bench_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace nearfield::fit {
namespace {

double phi_at(const Slab& planes, int m, glm::dvec2 u_m) {
    const glm::dvec2 center_m = planes.basis_center_m(m % planes.grid.x, m / planes.grid.x);
    const glm::dvec2 x = (u_m - center_m) / planes.pitch_m;
    return model::eval(planes.profile, x.x) * model::eval(planes.profile, x.y);
}

double cos4_at(const Slab& planes, glm::dvec2 u_m, glm::dvec2 s_m) {
    return std::pow(glm::length(glm::dvec3(u_m - s_m, planes.delta_m)) / planes.delta_m, -4.0);
}

glm::dvec2 texel_center_m(const Slab& planes, int i, int j) {
    return planes.s_min_m + glm::dvec2(i + 0.5, j + 0.5) * planes.texel_m();
}

// What the filter at position k lets through of the ray from u on U to s: the point where the ray
// meets the filter's plane, found from the plane's equation.
double transmission_at(
    const Slab& planes, const Optics& optics, std::size_t k, glm::dvec2 u_m, glm::dvec2 s_m) {
    const glm::dvec3 center = optics.position_m[k];
    const glm::dvec3 normal(-optics.filter_slope, 1.0);
    const glm::dvec3 from(u_m, -planes.delta_m), along = glm::dvec3(s_m, 0.0) - from;
    const double at = glm::dot(center - from, normal) / glm::dot(along, normal);
    const glm::dvec2 x =
        (glm::dvec2(from + at * along) - glm::dvec2(center)) / optics.filter_pitch_m;
    return model::eval(optics.filter_x, x.x) * model::eval(optics.filter_y, x.y);
}

// Sum over the midpoints of a fine grid, which knows no pieces.
double integral_over_u(const Slab& planes,
                       glm::dvec2 center_m,
                       int steps,
                       const std::function<double(glm::dvec2)>& f) {
    const glm::dvec2 half_m = 3.0 * planes.pitch_m;
    const glm::dvec2 step_m = 2.0 * half_m / static_cast<double>(steps);
    double sum = 0.0;
    for (int j = 0; j < steps; ++j)
        for (int i = 0; i < steps; ++i)
            sum += f(center_m - half_m + (glm::dvec2(i, j) + 0.5) * step_m);
    return sum * step_m.x * step_m.y;
}

// Largest difference of some entries from brute force, relative to G's largest entry.
double filter_error(const Slab& planes,
                    const Optics& optics,
                    int steps,
                    const std::optional<Optics>& believed = {}) {
    const Design design = make_design(planes, believed.value_or(optics));
    TexelDesign texel;
    fill_texel_design(design, 5, 1, texel);
    const glm::dvec2 s_m = texel_center_m(planes, 5, 1);
    const std::vector<double> g = dense(texel);
    const double most = *std::max_element(g.begin(), g.end());
    const int n = design.basis_count();
    double worst = 0.0;
    for (const int k : {0, 37, 48, 98})
        for (const int m : {0, 11, 36, 37, 47, 48, 49, 59, 60, 86, 98}) {
            const auto integrand = [&](glm::dvec2 u_m) {
                const double weight =
                    planes.weighting == Weighting::Radiance
                        ? cos4_at(planes, u_m, s_m) / (planes.delta_m * planes.delta_m)
                        : 1.0;
                return weight * phi_at(planes, m, u_m) *
                       transmission_at(planes, optics, static_cast<std::size_t>(k), u_m, s_m);
            };
            const double truth =
                integral_over_u(planes, planes.basis_center_m(m % planes.grid.x, m / planes.grid.x),
                                steps, integrand);
            worst =
                std::max(worst, std::abs(g[static_cast<std::size_t>(k * n + m)] - truth) / most);
        }
    return worst;
}

TEST(FilterDesign, IsTheConvolutionOfBSplinesAtGridPositions) {
    // Quadratic B-splines convolved are the quintic one: 66/120, 26/120, 1/120 at integers.
    const Slab planes = test_planes();
    const Design design = make_design(planes, test_filter(planes, 0.0));
    TexelDesign texel;
    fill_texel_design(design, 0, 0, texel);
    const std::vector<double> g = dense(texel);
    const double area_m2 = planes.pitch_m.x * planes.pitch_m.y;
    const double quintic[] = {66.0 / 120.0, 26.0 / 120.0, 1.0 / 120.0, 0.0};
    for (int k = 0; k < 99; ++k)
        for (int m = 0; m < 99; ++m) {
            const int dx = std::min(3, std::abs(k % 11 - m % 11));
            const int dy = std::min(3, std::abs(k / 11 - m / 11));
            EXPECT_NEAR(g[static_cast<std::size_t>(k * 99 + m)] / area_m2,
                        quintic[dx] * quintic[dy], 1e-14);
        }
}

TEST(FilterDesign, EqualsBruteForceAtUnevenPositions) {
    // What brute force itself misses at the kinks with these steps: 1.3e-5.
    Slab planes = test_planes();
    Optics optics = test_filter(planes, 0.0);
    support::Random random{3};
    for (glm::dvec3& p : optics.position_m)
        p += glm::dvec3(random.uniform(-0.004, 0.004), random.uniform(-0.004, 0.004), 0.0);
    optics.filter_x = model::make_profile("bilinear");
    optics.filter_pitch_m = {0.019, 0.0137};
    EXPECT_LT(filter_error(planes, optics, 600), 2e-5);
    EXPECT_FALSE(make_design(planes, optics).is_varying());
}

TEST(FilterDesign, EqualsBruteForceOffTheBasisPlane) {
    const Slab planes = test_planes();
    const Optics optics = test_filter(planes, 0.003);
    EXPECT_TRUE(make_design(planes, optics).is_varying());
    EXPECT_LT(filter_error(planes, optics, 600), 1e-5);
}

TEST(FilterDesign, EqualsBruteForceWithRadianceWeighting) {
    Slab planes = test_planes();
    planes.weighting = Weighting::Radiance;
    EXPECT_LT(filter_error(planes, test_filter(planes, 0.003), 400), 1.5e-5);
    // On U brute force has its steps on the kinks and is exact: three Gauss nodes' own error.
    EXPECT_LT(filter_error(planes, test_filter(planes, 0.0), 300), 1e-5);
}

TEST(FilterDesign, FollowsATiltedFilterAlongEachAxis) {
    // What is neglected, shear and the change of width within one filter, stays: 1.3e-3 at a slope
    // of 1 %.
    const Slab planes = test_planes();
    Optics optics = test_filter(planes, 0.0);
    const Optics flat = optics;
    optics.filter_slope = {0.01, -0.01};
    const double error = filter_error(planes, optics, 300);
    EXPECT_LT(error, 1.5e-3);
    EXPECT_GT(filter_error(planes, optics, 300, flat), 2.0 * error);
}

TEST(FilterDesign, NeglectedTurnCostsAThirtiethOfItself) {
    // A filter turned by alpha about z against one that is not, by brute force.
    const Slab planes = test_planes();
    const Optics optics = test_filter(planes, 0.0);
    const auto entry = [&](double alpha, int m) {
        const glm::dvec2 center_m(optics.position_m[48]);
        return integral_over_u(planes, center_m, 400, [&](glm::dvec2 u_m) {
            const glm::dvec2 x = u_m - center_m;
            const glm::dvec2 turned(std::cos(alpha) * x.x + std::sin(alpha) * x.y,
                                    std::cos(alpha) * x.y - std::sin(alpha) * x.x);
            return phi_at(planes, m, u_m) *
                   model::eval(optics.filter_x, turned.x / planes.pitch_m.x) *
                   model::eval(optics.filter_y, turned.y / planes.pitch_m.y);
        });
    };
    for (const double alpha : {0.01, 0.03}) {
        double worst = 0.0;
        for (const int m : {48, 49, 59, 60, 50, 61})
            worst = std::max(worst, std::abs(entry(alpha, m) - entry(0.0, m)));
        EXPECT_LT(worst / entry(0.0, 48), alpha / 30.0);
        EXPECT_GT(worst / entry(0.0, 48), alpha / 60.0);
    }
}

TEST(PinholeDesign, IsTheBasisAtTheHoleSeenFromTheTexel) {
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance}) {
        Slab planes = test_planes({5, 4}, "quadratic");
        planes.weighting = weighting;
        Optics optics = test_filter(planes, 0.002);
        optics.sensor = Sensor::Pinhole;
        optics.pinhole_area_m2 = 1e-6;
        const Design design = make_design(planes, optics);
        TexelDesign texel;
        fill_texel_design(design, 7, 0, texel);
        const std::vector<double> g = dense(texel);
        const glm::dvec2 s_m = texel_center_m(planes, 7, 0);
        for (std::size_t k = 0; k < 20; ++k) {
            const glm::dvec3 hole = optics.position_m[k];
            const glm::dvec3 ray = hole - glm::dvec3(s_m, 0.0);
            const glm::dvec2 u_m = s_m + glm::dvec2(ray) * (-planes.delta_m / ray.z);
            const double weight =
                weighting == Weighting::Radiance ? cos4_at(planes, u_m, s_m) / (0.2 * 0.2) : 1.0;
            for (int m = 0; m < 20; ++m)
                EXPECT_NEAR(g[k * 20 + static_cast<std::size_t>(m)],
                            1e-6 * weight * phi_at(planes, m, u_m), 1e-18 * 25);
        }
    }
}

TEST(CameraDesign, SeesRadiance) {
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance}) {
        Slab planes = test_planes({5, 4});
        planes.weighting = weighting;
        Optics optics = test_filter(planes, 0.0);
        optics.sensor = Sensor::Camera;
        const Design design = make_design(planes, optics);
        EXPECT_EQ(design.is_varying(), weighting == Weighting::Irradiance);
        TexelDesign texel;
        fill_texel_design(design, 2, 5, texel);
        const std::vector<double> g = dense(texel);
        const glm::dvec2 s_m = texel_center_m(planes, 2, 5);
        for (std::size_t k = 0; k < 20; ++k) {
            const glm::dvec2 u_m(optics.position_m[k]);
            const double weight =
                weighting == Weighting::Irradiance ? 0.04 / cos4_at(planes, u_m, s_m) : 1.0;
            for (int m = 0; m < 20; ++m)
                EXPECT_NEAR(g[k * 20 + static_cast<std::size_t>(m)],
                            weight * phi_at(planes, m, u_m), 1e-14);
        }
    }
}

TEST(Design, RefusesWhatCannotBeMeasured) {
    const Slab planes = test_planes();
    Optics optics = test_filter(planes, 0.0);
    optics.position_m[3].z = 0.1;
    EXPECT_THROW((void)make_design(planes, optics), Error);
    optics = test_filter(planes, 0.0);
    optics.filter_pitch_m.y = 0.0;
    EXPECT_THROW((void)make_design(planes, optics), Error);
    optics.sensor = Sensor::Pinhole;
    EXPECT_THROW((void)make_design(planes, optics), Error);
    EXPECT_THROW((void)make_design(planes, Optics{}), Error);
}

TEST(BasisRipple, IsWhatTheProfilesSay) {
    for (const char* name : {"box", "bilinear", "bspline"}) {
        const Ripple ripple = basis_ripple(test_planes({5, 5}, name));
        EXPECT_NEAR(ripple.least, 1.0, 1e-14) << name;
        EXPECT_NEAR(ripple.most, 1.0, 1e-14) << name;
    }
    const Ripple ripple = basis_ripple(test_planes({5, 5}, "quadratic"));
    EXPECT_NEAR(ripple.least, 1.0, 1e-14);
    EXPECT_NEAR(ripple.most, 2.25, 1e-14);
}

}  // namespace
}  // namespace nearfield::fit
