// SPDX-License-Identifier: Apache-2.0
// The sum in float with SIMD, and samples of the aperture, against the oracle at the very receivers
// in float.
#include "formats/model/prepared.h"

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
using support::as_double;
using support::as_float;
using support::facing_range;
using support::FacingRange;
using support::hard_receivers;
using support::HardReceiver;
using support::kHardHeights;
using support::LampShape;
using support::measured_profile;
using support::oracle_irradiance;
using support::Random;
using support::random_lamp;
using support::scaled_lamp;
using support::sidak_z_limit;

constexpr double kTypical = 2e-6;  // float32 sums of a few hundred products
constexpr double kHard = 1e-3;     // the bound for the cases where float32 cancels

constexpr Weighting kWeightings[] = {Weighting::Irradiance, Weighting::Radiance};

double relative_error(glm::dvec3 got, glm::dvec3 expected) {
    double worst = 0.0;
    for (int c = 0; c < 3; ++c)
        if (got[c] != expected[c]) {
            const double error = std::abs(got[c] - expected[c]) / std::abs(expected[c]);
            worst = std::isnan(error) ? INFINITY : std::max(worst, error);
        }
    return worst;
}

bool is_finite_and_not_negative(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && v.x >= 0.0F &&
           v.y >= 0.0F && v.z >= 0.0F;
}

/// Every kind of receiver at every height; returns relative errors of those that float32 should
/// find easy.
std::vector<double> expect_float_sum_is_close(const Slab& slab,
                                              std::uint64_t seed,
                                              const std::string& where) {
    std::vector<double> typical;
    const PreparedSlab prepared = prepare(slab);
    for (const double height_per_delta : kHardHeights)
        for (const HardReceiver& hard : hard_receivers(slab, height_per_delta, ++seed)) {
            const ReceiverF receiver = as_float(hard.receiver);
            const glm::vec3 got = irradiance(prepared, receiver);
            EXPECT_TRUE(is_finite_and_not_negative(got)) << where << ", " << hard.name;
            const FacingRange range = facing_range(slab, as_double(receiver));
            const bool is_cut = range.low_m < 0.0 && range.high_m > 0.0;
            const glm::dvec3 expected = oracle_irradiance(slab, as_double(receiver));
            const double error = relative_error(glm::dvec3(got), expected);
            EXPECT_LE(error, kHard)
                << where << ", " << hard.name << ": relative error " << error << ", expected ("
                << expected.x << ", " << expected.y << ", " << expected.z << "), got (" << got.x
                << ", " << got.y << ", " << got.z << ")";
            if (!is_cut && expected.x > 0.0)
                typical.push_back(error);
        }
    return typical;
}

TEST(FloatSum, IsCloseForEveryProfileWeightingHeightAndKindOfReceiver) {
    std::uint64_t seed = 3000;
    for (const Weighting weighting : kWeightings) {
        std::vector<double> errors;
        for (const Profile& profile : all_profiles())
            for (const int channels : {1, 3}) {
                ++seed;
                LampShape shape;
                shape.channels = channels;
                const std::vector<double> some = expect_float_sum_is_close(
                    random_lamp(profile, weighting, seed, shape), seed * 100, profile.name);
                errors.insert(errors.end(), some.begin(), some.end());
            }
        std::ranges::sort(errors);
        const bool exact = weighting == Weighting::Irradiance;
        EXPECT_LE(errors[errors.size() / 2], kTypical);
        const std::string name = exact ? "irradiance" : "radiance";
        RecordProperty(name + "_median_1e-9", std::to_string(errors[errors.size() / 2] * 1e9));
        RecordProperty(name + "_p95_1e-9", std::to_string(errors[errors.size() * 95 / 100] * 1e9));
        RecordProperty(name + "_worst_1e-9", std::to_string(errors.back() * 1e9));
    }
}

TEST(FloatSum, IsCloseForOddShapesAndLittleLight) {
    const glm::ivec2 grids[] = {{1, 1}, {1, 4}, {5, 1}, {2, 3}};
    const glm::ivec2 texel_counts[] = {{1, 1}, {1, 9}, {17, 1}, {3, 2}, {65, 48}};
    std::uint64_t seed = 4000;
    for (const glm::ivec2 grid : grids)
        for (const glm::ivec2 texels : texel_counts) {
            ++seed;
            LampShape shape;
            shape.grid = grid;
            shape.texels = texels;
            shape.dark_fraction = seed % 3 == 0 ? 0.9 : 0.0;
            shape.decades = seed % 5 == 0 ? 10 : 3;
            shape.channels = seed % 2 == 0 ? 3 : 1;
            expect_float_sum_is_close(
                random_lamp(measured_profile(), kWeightings[seed % 2], seed, shape), seed * 100,
                "grid " + std::to_string(grid.x) + " x " + std::to_string(grid.y) + ", texels " +
                    std::to_string(texels.x) + " x " + std::to_string(texels.y));
        }
}

TEST(FloatSum, IsZeroBehindUAndInTheDarkAndFiniteAtU) {
    for (const Weighting weighting : kWeightings) {
        Slab slab = random_lamp(make_profile("bspline"), weighting, 52);
        const PreparedSlab prepared = prepare(slab);
        const auto delta_m = static_cast<float>(slab.delta_m);
        std::vector<float> image_y(static_cast<std::size_t>(slab.image_count()));
        for (const glm::vec3 normal :
             {glm::vec3(0, 0, -1), glm::vec3(0, 0, 1), glm::vec3(1, 0, 0)}) {
            for (const float behind : {1e-6F, 0.1F, 1.0F, 1e6F}) {
                std::ranges::fill(image_y, 1.0F);
                const ReceiverF receiver{{0.01F, 0.0F, -delta_m * (1.0F + behind)}, normal};
                EXPECT_EQ(irradiance(prepared, receiver, image_y), glm::vec3(0.0F));
                EXPECT_EQ(*std::ranges::max_element(image_y), 0.0F);
            }
            for (const float z_m : {-delta_m, std::nextafter(-delta_m, 0.0F)})
                EXPECT_TRUE(
                    is_finite_and_not_negative(irradiance(prepared, {{0.01F, 0.0F, z_m}, normal})))
                    << z_m;
        }
        std::ranges::fill(slab.coeffs, 0.0F);
        const PreparedSlab dark = prepare(slab);
        EXPECT_EQ(irradiance(dark, {{0.01F, 0.0F, 0.5F}, {0, 0, -1}}, image_y), glm::vec3(0.0F));
        EXPECT_EQ(*std::ranges::max_element(image_y), 0.0F);
    }
}

TEST(FloatSum, ScalesAsRadianceIsKept) {
    constexpr double kScaling = 1e-5;  // two float sums at receivers rounded apart
    for (const Weighting weighting : kWeightings) {
        LampShape smooth;
        smooth.decades = 1;
        const Slab slab = random_lamp(make_profile("bspline"), weighting, 62, smooth);
        for (const double factor : {1.0 / 1024, 1.0 / 32, 16.0, 1024.0}) {
            const PreparedSlab here = prepare(slab), scaled = prepare(scaled_lamp(slab, factor));
            for (const double height_per_delta : {-0.5, 0.0, 1.0, 1e3}) {
                const Receiver receiver = hard_receivers(slab, height_per_delta, 62)[1].receiver;
                ReceiverF there = as_float(receiver);
                there.position_m *= static_cast<float>(factor);  // exact: a power of two
                EXPECT_LE(relative_error(glm::dvec3(irradiance(scaled, there)),
                                         glm::dvec3(irradiance(here, as_float(receiver)))),
                          kScaling)
                    << factor << ", " << height_per_delta;
            }
        }
    }
}

// image_y is each image's share of Y, what the oracle gives with every other image dark.
TEST(FloatSum, SharesOfImagesAreTheirOwnIrradiance) {
    LampShape shape;
    shape.channels = 3;
    for (const Weighting weighting : kWeightings) {
        const Slab slab = random_lamp(make_profile("bspline"), weighting, 72, shape);
        const PreparedSlab prepared = prepare(slab);
        const auto count = static_cast<std::size_t>(slab.image_count());
        std::vector<Slab> alone(count, slab);
        for (std::size_t m = 0; m < count; ++m)
            for (std::size_t k = 0; k < slab.coeffs.size(); ++k)
                if (k / slab.texel_count() % count != m)
                    alone[m].coeffs[k] = 0.0F;
        for (const double height_per_delta : {-0.5, 0.0, 1.0, 30.0})
            for (const HardReceiver& hard : hard_receivers(slab, height_per_delta, 73)) {
                std::vector<float> image_y(count, -1.0F);
                const ReceiverF receiver = as_float(hard.receiver);
                const glm::vec3 all = irradiance(prepared, receiver, image_y);
                double sum = 0.0;
                for (std::size_t m = 0; m < count; ++m) {
                    const double expected =
                        luminance(oracle_irradiance(alone[m], as_double(receiver)));
                    EXPECT_LE(std::abs(image_y[m] - expected), kHard * expected)
                        << hard.name << ", image " << m << ": expected " << expected << ", got "
                        << image_y[m];
                    sum += image_y[m];
                }
                EXPECT_LE(std::abs(sum - luminance(glm::dvec3(all))), 1e-5 * sum) << hard.name;
            }
    }
}

// Channels are summed together where a window is narrow: each must come out as if it were alone,
// for windows from less than a texel to all of an image, and neighbors at once as each by itself.
TEST(FloatSum, ChannelsAndNeighborsDoNotMix) {
    LampShape shape;
    shape.channels = 3;
    for (const Weighting weighting : kWeightings) {
        const Slab slab = random_lamp(make_profile("bspline"), weighting, 91, shape);
        const PreparedSlab prepared = prepare(slab);
        const std::size_t channel_size = slab.coeffs.size() / 3;
        std::vector<ReceiverF> receivers;
        for (const float height_m : {-0.15F, -0.02F, 0.01F, 0.05F, 0.3F, 2.0F})
            for (const float x_m : {-0.04F, 0.0F, 0.03F})
                receivers.push_back({{x_m, 0.01F, height_m}, {0.1F, -0.2F, -0.974679F}});
        std::vector<glm::vec3> together(receivers.size());
        irradiance(prepared, receivers, together);
        for (int c = 0; c < 3; ++c) {
            Slab alone = slab;
            alone.channels = 1;
            const auto first = slab.coeffs.begin() + static_cast<std::ptrdiff_t>(channel_size) * c;
            alone.coeffs.assign(first, first + static_cast<std::ptrdiff_t>(channel_size));
            const PreparedSlab prepared_alone = prepare(alone);
            for (std::size_t k = 0; k < receivers.size(); ++k) {
                const glm::vec3 expected = irradiance(prepared_alone, receivers[k]);
                EXPECT_NEAR(together[k][c], expected.x, kTypical * expected.x) << k;
            }
        }
        for (std::size_t k = 0; k < receivers.size(); ++k)
            EXPECT_EQ(together[k], irradiance(prepared, receivers[k])) << k;
    }
}

struct Estimate {
    glm::dvec3 mean{0.0}, sigma{0.0};
};

// Mean of the weights of so many points drawn for a receiver that sees light, and its standard
// error.
Estimate draw_aperture(const PreparedSlab& prepared,
                       const ReceiverF& receiver,
                       std::span<const float> image_y,
                       std::uint64_t seed) {
    constexpr int kSamples = 40000;
    float image_y_sum = 0.0F;
    for (const float y : image_y)
        image_y_sum += y;
    Random random{seed};
    const auto uniform = [&] { return static_cast<float>(random.bits() >> 40U) * 0x1p-24F; };
    glm::dvec3 sum(0.0), squares(0.0);
    for (int k = 0; k < kSamples; ++k) {
        const float select = uniform(), x = uniform(), y = uniform();
        const ApertureSample sample =
            sample_aperture(prepared, receiver, image_y, image_y_sum, select, {x, y});
        EXPECT_TRUE(is_finite_and_not_negative(sample.weight));
        const glm::dvec3 weight(sample.weight);
        sum += weight;
        squares += weight * weight;
    }
    const glm::dvec3 mean = sum / double(kSamples);
    return {mean, glm::sqrt(glm::max(glm::dvec3(0.0), squares / double(kSamples) - mean * mean) /
                            double(kSamples - 1))};
}

// The mean of weights is E, channel by channel: unbiased. Weights times 1.05 would be seen.
TEST(FloatSum, ApertureSamplesAreUnbiased) {
    constexpr double kPlanted = 1.05;
    LampShape shape;
    shape.channels = 3;
    shape.decades = 2;
    int count = 0;
    double worst = 0.0, worst_planted = 0.0;
    std::uint64_t seed = 5000;
    for (const Profile& profile : all_profiles())
        for (const Weighting weighting : kWeightings) {
            const Slab slab = random_lamp(profile, weighting, ++seed, shape);
            const PreparedSlab prepared = prepare(slab);
            std::vector<float> image_y(static_cast<std::size_t>(slab.image_count()));
            for (const double height_per_delta : {-0.5, 0.0, 1.0, 30.0}) {
                const std::vector<HardReceiver> all =
                    hard_receivers(slab, height_per_delta, ++seed);
                for (const HardReceiver& hard : {all[1], all[4], all[7]}) {
                    const ReceiverF receiver = as_float(hard.receiver);
                    irradiance(prepared, receiver, image_y);
                    if (*std::ranges::max_element(image_y) == 0.0F)
                        continue;
                    const glm::dvec3 expected = oracle_irradiance(slab, as_double(receiver));
                    const auto [mean, sigma] = draw_aperture(prepared, receiver, image_y, ++seed);
                    const int c = count % 3;
                    ++count;
                    const double z = std::abs(mean[c] - expected[c]) / sigma[c];
                    EXPECT_LE(z, 4.5) << profile.name << ", " << hard.name;
                    worst = std::max(worst, z);
                    worst_planted = std::max(worst_planted,
                                             std::abs(mean[c] - kPlanted * expected[c]) / sigma[c]);
                }
            }
        }
    EXPECT_LE(worst, sidak_z_limit(count)) << "over " << count << " receivers";
    EXPECT_GT(worst_planted, sidak_z_limit(count));
    EXPECT_GT(count, 60);
}

}  // namespace
}  // namespace nearfield::model
