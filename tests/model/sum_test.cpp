// SPDX-License-Identifier: Apache-2.0
// The exact sum in double against the oracle (tests/support/oracle.h), which integrates the
// definition on U and shares no formula with it. Receivers: every kind at every height of
// kHardHeights.
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"
#include "tests/support/random.h"
#include "tests/support/receivers.h"
#include "tests/support/z_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::model {
namespace {

using support::all_profiles;
using support::Estimate;
using support::hard_receivers;
using support::HardReceiver;
using support::kHardHeights;
using support::LampShape;
using support::measured_profile;
using support::oracle_flux;
using support::oracle_intensity;
using support::oracle_irradiance;
using support::oracle_monte_carlo;
using support::oracle_radiance;
using support::Random;
using support::random_lamp;
using support::rotation_about;
using support::scaled_lamp;
using support::sidak_z_limit;

// Irradiance weighting is exact but for rounding; 1e-6 covers planes that cut U from 1e6 delta
// away.
constexpr double kExact = 1e-6;
// Radiance weighting: the bound that luminaire.h states for its quadrature of 1/R^4.
constexpr double kQuadrature = 1e-4;

double tolerance_of(Weighting weighting) {
    return weighting == Weighting::Irradiance ? kExact : kQuadrature;
}

const char* name_of(Weighting weighting) {
    return weighting == Weighting::Irradiance ? "irradiance weighting" : "radiance weighting";
}

constexpr Weighting kWeightings[] = {Weighting::Irradiance, Weighting::Radiance};

/// Largest relative error among the channels; 0 where both are 0, infinite where only the truth is
/// or got is not finite.
double relative_error(glm::dvec3 got, glm::dvec3 expected) {
    double worst = 0.0;
    for (int c = 0; c < 3; ++c)
        if (got[c] != expected[c]) {
            const double error = std::abs(got[c] - expected[c]) / std::abs(expected[c]);
            worst = std::isnan(error) ? INFINITY : std::max(worst, error);
        }
    return worst;
}

::testing::AssertionResult is_within(glm::dvec3 got, glm::dvec3 expected, double tolerance) {
    const double error = relative_error(got, expected);
    if (error <= tolerance)
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure()
           << "expected (" << expected.x << ", " << expected.y << ", " << expected.z << "), got ("
           << got.x << ", " << got.y << ", " << got.z << "), relative error " << error;
}

/// Every kind of receiver at every height, against the oracle; returns the largest relative error.
double expect_sum_is_exact(const Slab& slab, std::uint64_t seed, const std::string& where) {
    double worst = 0.0;
    for (const double height_per_delta : kHardHeights)
        for (const HardReceiver& hard : hard_receivers(slab, height_per_delta, ++seed)) {
            const glm::dvec3 got = irradiance(slab, hard.receiver);
            const glm::dvec3 expected = oracle_irradiance(slab, hard.receiver);
            EXPECT_TRUE(is_within(got, expected, tolerance_of(slab.weighting)))
                << where << ", " << hard.name;
            worst = std::max(worst, relative_error(got, expected));
        }
    return worst;
}

// Rounding is measured against the largest radiance: at a support's end basis functions cancel to
// nothing.
TEST(Sum, RadianceIsTheSumOverImages) {
    constexpr double kRounding = 1e-13;
    Random random{2};
    LampShape shape;
    shape.channels = 3;
    for (const Profile& profile : all_profiles())
        for (const Weighting weighting : kWeightings) {
            const Slab slab = random_lamp(profile, weighting, 21, shape);
            double worst = 0.0, largest = 0.0;
            for (int k = 0; k < 300; ++k) {
                const double ux = random.uniform(-0.15, 0.15), uy = random.uniform(-0.1, 0.1);
                const double sx = random.uniform(-0.2, 0.2), sy = random.uniform(-0.12, 0.12);
                const glm::dvec3 expected = oracle_radiance(slab, {ux, uy}, {sx, sy});
                const glm::dvec3 got = radiance(slab, {ux, uy}, {sx, sy});
                worst = std::max(worst, glm::length(got - expected));
                largest = std::max(largest, glm::length(expected));
            }
            EXPECT_LE(worst, kRounding * largest) << profile.name << ", " << name_of(weighting);
            EXPECT_GT(largest, 0.0);
        }
}

// The claim of exactness: from -0.9 delta to 1e6 delta, whatever the receiver's normal.
TEST(Sum, EqualsBruteForceForEveryProfileWeightingHeightAndKindOfReceiver) {
    std::uint64_t seed = 500;
    for (const Profile& profile : all_profiles())
        for (const Weighting weighting : kWeightings)
            for (const int channels : {1, 3}) {
                ++seed;
                LampShape shape;
                shape.channels = channels;
                const std::string where = profile.name + ", " + name_of(weighting);
                const double worst = expect_sum_is_exact(
                    random_lamp(profile, weighting, seed, shape), 100 * seed, where);
                RecordProperty(where + ", " + std::to_string(channels),
                               std::to_string(worst * 1e12));
            }
}

// Shapes that trip indices: one image, one texel, one row or column of either, a texel larger than
// the aperture.
TEST(Sum, IsExactForOddShapes) {
    const glm::ivec2 grids[] = {{1, 1}, {1, 4}, {5, 1}, {2, 3}};
    const glm::ivec2 texel_counts[] = {{1, 1}, {1, 9}, {17, 1}, {3, 2}, {64, 48}};
    std::uint64_t seed = 900;
    for (const char* profile : {"box", "bspline"})
        for (const glm::ivec2 grid : grids)
            for (const glm::ivec2 texels : texel_counts) {
                ++seed;
                LampShape shape;
                shape.grid = grid;
                shape.texels = texels;
                shape.dark_fraction = 0.0;
                expect_sum_is_exact(
                    random_lamp(make_profile(profile), kWeightings[seed % 2], seed, shape),
                    seed * 100, profile);
            }
}

// An aperture five times as wide as the planes are apart: rays to 70 degrees, a kernel that varies
// within a cell.
TEST(Sum, IsExactForALampWiderThanItIsDeep) {
    LampShape shape;
    shape.delta_m = 0.03;
    shape.pitch_m = {0.031, 0.026};
    std::uint64_t seed = 950;
    for (const Profile& profile : all_profiles())
        for (const Weighting weighting : kWeightings) {
            ++seed;
            const double worst = expect_sum_is_exact(random_lamp(profile, weighting, seed, shape),
                                                     100 * seed, profile.name);
            RecordProperty(profile.name + ", " + name_of(weighting) + ", 1",
                           std::to_string(worst * 1e12));
        }
}

// Few texels lit, a dark lamp, and ten powers of ten within one image.
TEST(Sum, IsExactWhereLittleIsLit) {
    const Slab blank = [] {
        Slab slab = random_lamp(make_profile("bspline"), Weighting::Irradiance, 4);
        std::ranges::fill(slab.coeffs, 0.0F);
        return slab;
    }();
    const auto lit = [&](const auto& is_lit) {
        Slab slab = blank;
        for (int m = 0; m < slab.image_count(); ++m)
            for (int t = 0; t < static_cast<int>(slab.texel_count()); ++t)
                if (is_lit(t % slab.texels.x, t / slab.texels.x))
                    slab.coeffs[slab.image_offset(0, m) + static_cast<std::size_t>(t)] = 5.0F;
        return slab;
    };
    const int w = blank.texels.x, h = blank.texels.y;
    EXPECT_EQ(expect_sum_is_exact(blank, 1, "dark"), 0.0);
    EXPECT_EQ(flux(blank).x, 0.0);
    EXPECT_EQ(intensity(blank, {0, 0, 1}).x, 0.0);
    expect_sum_is_exact(lit([&](int i, int j) { return i == 11 && j == 9; }), 2, "one texel");
    expect_sum_is_exact(lit([&](int i, int) { return i == 12; }), 3, "one column");
    expect_sum_is_exact(lit([&](int, int j) { return j == 10; }), 4, "one row");
    expect_sum_is_exact(lit([&](int i, int) { return i == w - 1; }), 5, "last column");
    expect_sum_is_exact(lit([&](int i, int) { return i == 0; }), 6, "first column");
    expect_sum_is_exact(lit([&](int, int j) { return j == h - 1; }), 7, "last row");
    LampShape wide;
    wide.decades = 10;
    expect_sum_is_exact(random_lamp(make_profile("bspline"), Weighting::Irradiance, 5, wide), 8,
                        "range 1e10");
}

TEST(Sum, FluxEqualsTheFourDimensionalIntegral) {
    LampShape shape;
    shape.channels = 3;
    shape.texels = {9, 7};
    LightField both;
    for (const Profile& profile : all_profiles())
        for (const Weighting weighting : kWeightings) {
            const Slab slab = random_lamp(profile, weighting, 31, shape);
            EXPECT_TRUE(is_within(flux(slab), oracle_flux(slab), tolerance_of(weighting)))
                << profile.name << ", " << name_of(weighting);
            both.slabs.push_back(slab);
        }
    glm::dvec3 sum(0.0);
    for (const Slab& slab : both.slabs)
        sum += flux(slab);
    EXPECT_TRUE(is_within(flux(both), sum, 1e-12));
}

TEST(Sum, IntensityEqualsBruteForceAndIsTheFarFieldOfIrradiance) {
    constexpr double kFarPerDelta = 1e6;
    // Seen from 1e6 delta, edges on S lie 1e-6 of their distance off: 1e-5 of the light. Where the
    // far field meets S's border alone, on a window of a few millimetres, that is more of what
    // little there is.
    constexpr double kFarField = 1e-5, kFarFieldAtBorder = 1e-3;
    const glm::dvec3 directions[] = {{0, 0, 1},       {0.3, -0.2, 1},  {-0.41, 0.13, 2},
                                     {0.7, 0.1, 0.9}, {-0.2, -0.6, 1}, {5, 0, 1}};
    LampShape shape;
    shape.channels = 3;
    shape.decades = 1;
    for (const Profile& profile : all_profiles())
        for (const Weighting weighting : kWeightings) {
            const Slab slab = random_lamp(profile, weighting, 41, shape);
            for (const glm::dvec3 direction : directions) {
                const glm::dvec3 got = intensity(slab, direction);
                EXPECT_TRUE(is_within(got, oracle_intensity(slab, direction), kExact))
                    << profile.name << ", " << name_of(weighting);
                const glm::dvec3 unit = glm::normalize(direction);
                const double r_m = kFarPerDelta * slab.delta_m / unit.z;
                const bool at_border = std::abs(direction.x / direction.z) > 0.5 ||
                                       std::abs(direction.y / direction.z) > 0.5;
                EXPECT_TRUE(is_within(irradiance(slab, {r_m * unit, -unit}) * r_m * r_m, got,
                                      at_border ? kFarFieldAtBorder : kFarField))
                    << profile.name << ", " << name_of(weighting);
            }
            EXPECT_EQ(intensity(slab, {0.2, 0.1, -1.0}).x, 0.0);
            EXPECT_EQ(intensity(slab, {1.0, 0.0, 0.0}).x, 0.0);
        }
}

// Behind U no light at all; at U, where the formulas divide by zero, a finite number.
TEST(Sum, IsZeroBehindUAndFiniteAtIt) {
    for (const Weighting weighting : kWeightings) {
        const Slab slab = random_lamp(make_profile("bspline"), weighting, 51);
        for (const glm::dvec3 normal :
             {glm::dvec3(0, 0, -1), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0)}) {
            for (const double behind : {1e-12, 1e-6, 0.1, 1.0, 1e6})
                EXPECT_EQ(irradiance(slab, {{0.01, 0.0, -slab.delta_m * (1.0 + behind)}, normal}),
                          glm::dvec3(0.0));
            const glm::dvec3 at = irradiance(slab, {{0.01, 0.0, -slab.delta_m}, normal});
            EXPECT_TRUE(std::isfinite(at.x) && at.x >= 0.0) << at.x;
            const glm::dvec3 near =
                irradiance(slab, {{0.01, 0.0, -slab.delta_m * (1.0 - 1e-9)}, normal});
            EXPECT_TRUE(std::isfinite(near.x) && near.x >= 0.0) << near.x;
        }
    }
}

// Geometry times lambda with radiance kept: irradiance at the scaled point is the same, flux goes
// with lambda^2.
TEST(Sum, ScalesAsRadianceIsKept) {
    constexpr double kScaling = 1e-5;  // coefficients are rounded to float again
    for (const Weighting weighting : kWeightings) {
        const Slab slab = random_lamp(make_profile("bspline"), weighting, 61);
        for (const double factor : {1e-3, 0.02, 7.0, 1e3}) {
            const Slab scaled = scaled_lamp(slab, factor);
            EXPECT_TRUE(is_within(flux(scaled) / (factor * factor), flux(slab), kScaling));
            for (const double height_per_delta : {-0.9, -1e-4, 0.0, 1.0, 1e3})
                for (const HardReceiver& hard : hard_receivers(slab, height_per_delta, 61)) {
                    Receiver there = hard.receiver;
                    there.position_m *= factor;
                    EXPECT_TRUE(is_within(irradiance(scaled, there),
                                          irradiance(slab, hard.receiver), kScaling))
                        << hard.name << ", scaled by " << factor;
                }
        }
    }
}

LightField box_of_slabs() {
    LightField lamp;
    const glm::dvec3 x(1, 0, 0), y(0, 1, 0);
    const double quarter_turn = std::acos(0.0);
    const glm::dmat3 rotations[] = {glm::dmat3(1.0), rotation_about(x, quarter_turn),
                                    rotation_about(x, -quarter_turn),
                                    rotation_about(y, quarter_turn), rotation_about(y, 2.1)};
    std::uint64_t seed = 70;
    for (const glm::dmat3& rotation : rotations) {
        ++seed;
        Slab slab = random_lamp(measured_profile(), kWeightings[seed % 2], seed);
        slab.luminaire_from_slab = {rotation, rotation * glm::dvec3(0.01, -0.02, 0.1)};
        lamp.slabs.push_back(slab);
    }
    return lamp;
}

TEST(Sum, AddsSlabsInTheirPosesAndTurnsWithThem) {
    const LightField lamp = box_of_slabs();
    const glm::dmat3 turn = rotation_about(glm::normalize(glm::dvec3(1, -2, 0.5)), 1.234);
    const glm::dvec3 shift_m(3.0, -1.0, 0.7);
    LightField turned = lamp;
    for (Slab& slab : turned.slabs) {
        Rigid& pose = slab.luminaire_from_slab;
        pose = {turn * pose.rotation, turn * pose.translation_m + shift_m};
    }
    Random random{3};
    for (int k = 0; k < 100; ++k) {
        glm::dvec3 p_m(0.0), normal(0.0);
        for (int d = 0; d < 3; ++d) {
            p_m[d] = random.uniform(-1.0, 1.0);
            normal[d] = random.uniform(-1.0, 1.0);
        }
        const Receiver receiver{p_m, glm::normalize(normal)};
        const glm::dvec3 got = irradiance(lamp, receiver);
        EXPECT_TRUE(is_within(got, oracle_irradiance(lamp, receiver), kQuadrature))
            << "receiver " << k;
        const Receiver there{turn * p_m + shift_m, turn * receiver.normal};
        EXPECT_TRUE(is_within(irradiance(turned, there), got, 1e-9)) << "receiver " << k;
        // Reflected pairs of slabs share directions; each knows only those in front of it.
        glm::dvec3 sum(0.0);
        for (const Slab& slab : lamp.slabs)
            sum += oracle_intensity(
                slab, glm::transpose(slab.luminaire_from_slab.rotation) * receiver.normal);
        EXPECT_TRUE(is_within(intensity(lamp, 3.0 * receiver.normal), sum, kExact))
            << "direction " << k;
    }
}

// Sampling the definition, not integrating it: a third way to the same number.
TEST(Sum, MonteCarloAgreesWithin3Sigma) {
    constexpr int kSamples = 20000;
    int count = 0;
    double worst = 0.0;
    std::uint64_t seed = 2000;
    LampShape shape;
    shape.decades = 2;  // so that 20,000 samples estimate their own variance well
    for (const Profile& profile : all_profiles())
        for (const Weighting weighting : kWeightings) {
            const Slab slab = random_lamp(profile, weighting, ++seed, shape);
            for (const double height_per_delta : {-0.5, 0.0, 0.3, 1.0, 30.0})
                for (const HardReceiver& hard : hard_receivers(slab, height_per_delta, ++seed)) {
                    const Estimate estimate =
                        oracle_monte_carlo(slab, hard.receiver, kSamples, ++seed);
                    const double got = irradiance(slab, hard.receiver).x;
                    if (estimate.standard_error.x == 0.0)
                        continue;
                    ++count;
                    worst = std::max(worst,
                                     std::abs(got - estimate.mean.x) / estimate.standard_error.x);
                }
        }
    EXPECT_LE(worst, sidak_z_limit(count)) << "over " << count << " receivers";
    EXPECT_GT(count, 200);
}

// Sigma is what moving each coefficient by its own would give, in quadrature, and the common
// factor's share.
TEST(Sum, SigmaIsTheQuadratureSumOverTexels) {
    LampShape shape;
    shape.grid = {2, 2};
    shape.texels = {3, 4};
    shape.channels = 3;
    Slab slab = random_lamp(make_profile("bilinear"), Weighting::Irradiance, 81, shape);
    Random random{82};
    for (const float c : slab.coeffs)
        slab.sigma.push_back(0.1F * c + static_cast<float>(random.uniform()));
    LightField lamp;
    lamp.slabs = {slab};
    const Receiver receiver{{0.03, -0.01, 0.3}, glm::normalize(glm::dvec3(0.2, 0.1, -1.0))};
    double irradiance_variance = 0.0, flux_variance = 0.0;
    Slab one = slab;
    const std::size_t texels = slab.coeffs.size() / 3;
    for (std::size_t k = 0; k < texels; ++k) {
        std::ranges::fill(one.coeffs, 0.0F);
        for (std::size_t c = 0; c < 3; ++c)
            one.coeffs[c * texels + k] = slab.sigma[c * texels + k];
        irradiance_variance += std::pow(luminance(oracle_irradiance(one, receiver)), 2);
        flux_variance += std::pow(luminance(oracle_flux(one, 3)), 2);
    }
    EXPECT_NEAR(irradiance_sigma_y(lamp, receiver) / std::sqrt(irradiance_variance), 1.0, kExact);
    EXPECT_NEAR(flux_sigma_y(lamp) / std::sqrt(flux_variance), 1.0, kExact);

    lamp.scale_sigma_rel = 0.05;
    const double scale_share = 0.05 * luminance(oracle_irradiance(slab, receiver));
    EXPECT_NEAR(irradiance_sigma_y(lamp, receiver) /
                    std::sqrt(irradiance_variance + scale_share * scale_share),
                1.0, kExact);
    lamp.slabs[0].sigma.clear();
    EXPECT_NEAR(irradiance_sigma_y(lamp, receiver) / scale_share, 1.0, kExact);
}

}  // namespace
}  // namespace nearfield::model
