// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/sky_table.h"

#include "formats/shared/tonemap.glsl.h"
#include "tests/environment/skies.h"
#include "tests/support/chi_square.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace nearfield::environment {
namespace {

glm::vec2 random_pair(support::Random& random) {
    return {random.uniform(), random.uniform()};
}

// Proves that the density is luminance over its integral, and so is 1 in all; and that draw() says
// the density that density() has there.
TEST(SkyTable, DensityIsLuminanceOverItsIntegral) {
    const LatLong picture = test::sunny_sky(16);
    const SkyTable table = make_sky_table(picture);
    double whole = 0.0;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
            whole +=
                pixel_sr(picture, y) *
                static_cast<double>(shared::luminance709(picture.radiance[picture.index({x, y})]));
    double sum = 0.0;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x) {
            const double expected =
                static_cast<double>(shared::luminance709(picture.radiance[picture.index({x, y})])) /
                whole;
            const auto found =
                static_cast<double>(density(table, pixel_direction(picture, {x, y})));
            // Chances are steps of CDFs up to 1 in float: two roundings of 2^-25 each way.
            constexpr double kRounding = 4.0 * 0x1p-25;
            EXPECT_NEAR(found * pixel_sr(picture, y), expected * pixel_sr(picture, y), kRounding)
                << x << " " << y;
            sum += found * pixel_sr(picture, y);
        }
    EXPECT_NEAR(sum, 1.0, 1e-5);
    support::Random random{1};
    for (int k = 0; k < 1000; ++k) {
        const SkySample sample = draw(table, random_pair(random));
        EXPECT_GT(sample.density, 0.0F);
        EXPECT_EQ(sample.density, density(table, pixel_direction(picture, sample.pixel)));
        EXPECT_NEAR(glm::length(sample.direction), 1.0F, 1e-6F);
    }
}

/// Chance of directions drawn from one table if they had the other's density: counted in 64 zones
/// and sectors of equal probability along the draws' own order.
double chance(const LatLong& drawn, const LatLong& stated) {
    const SkyTable table = make_sky_table(drawn);
    constexpr int kDraws = 100000;
    std::vector<double> expected(stated.radiance.size()), observed(stated.radiance.size());
    const SkyTable truth = make_sky_table(stated);
    for (int y = 0; y < stated.size_px.y; ++y)
        for (int x = 0; x < stated.size_px.x; ++x)
            expected[stated.index({x, y})] =
                kDraws * pixel_sr(stated, y) *
                static_cast<double>(density(truth, pixel_direction(stated, {x, y})));
    support::Random random{2};
    for (int k = 0; k < kDraws; ++k) {
        // By the direction, not by the pixel that draw() names.
        const glm::dvec3 d(draw(table, random_pair(random)).direction);
        const double pi = std::acos(-1.0);
        const auto x =
            static_cast<int>((std::atan2(d.x, -d.z) / (2.0 * pi) + 0.5) * stated.size_px.x);
        const int y = static_cast<int>(std::acos(d.y) / pi * stated.size_px.y);
        observed[stated.index(glm::clamp(glm::ivec2(x, y), glm::ivec2(0), stated.size_px - 1))] +=
            1.0;
    }
    double sum = 0.0, rest_expected = 0.0, rest_observed = 0.0;
    int degrees = -1;
    for (std::size_t k = 0; k < expected.size(); ++k) {
        if (expected[k] < 10.0) {
            rest_expected += expected[k];
            rest_observed += observed[k];
            continue;
        }
        sum += std::pow(observed[k] - expected[k], 2) / expected[k];
        ++degrees;
    }
    if (rest_expected > 10.0) {
        sum += std::pow(rest_observed - rest_expected, 2) / rest_expected;
        ++degrees;
    }
    return support::chi_square_tail(sum, degrees);
}

// Proves draws by chi-square over pixels (significance 0.01), and that the test rejects a sky whose
// upper half is 10 % brighter.
TEST(SkyTable, DrawsByItsDensity) {
    const LatLong plain = test::sky(16, [](glm::dvec3 d) {
        return glm::vec3(static_cast<float>(1.0 + 0.9 * d.x + 0.05 * d.y));
    });
    EXPECT_GT(chance(plain, plain), 0.01);
    LatLong planted = plain;
    for (std::size_t k = 0; k < planted.radiance.size() / 2; ++k)
        planted.radiance[k] *= 1.1F;
    EXPECT_LT(chance(plain, planted), 1e-6);
    const LatLong sunny = test::sunny_sky(16);
    EXPECT_GT(chance(sunny, sunny), 0.01);
}

// Proves that a black picture draws nothing, and that one lit pixel draws nothing else.
TEST(SkyTable, DarkAndLonePixels) {
    const SkyTable dark = make_sky_table(test::lone_sun(8, {0, 0}, 0.0F));
    EXPECT_TRUE(dark.is_dark());
    EXPECT_EQ(draw(dark, {0.3F, 0.3F}).density, 0.0F);
    EXPECT_EQ(density(dark, {0, 1, 0}), 0.0F);
    for (const glm::ivec2 pixel : {glm::ivec2(0, 0), {15, 7}, {7, 3}}) {
        const LatLong picture = test::lone_sun(8, pixel, 1e-20F);
        const SkyTable table = make_sky_table(picture);
        support::Random random{3};
        for (int k = 0; k < 100; ++k)
            EXPECT_EQ(draw(table, random_pair(random)).pixel, pixel);
        EXPECT_NEAR(static_cast<double>(density(table, pixel_direction(picture, pixel))) *
                        pixel_sr(picture, pixel.y),
                    1.0, 1e-5);
    }
}

}  // namespace
}  // namespace nearfield::environment
