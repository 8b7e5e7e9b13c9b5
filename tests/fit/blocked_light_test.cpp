// SPDX-License-Identifier: Apache-2.0
// Light that comes beside the filter: found, and taken off every position by what it holds back.
#include "fit/measured_texels.h"
#include "formats/files/error.h"
#include "tests/fit/bench_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

constexpr glm::ivec2 kTexels{40, 30};
constexpr std::size_t kCount = 1200;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

double parabola(std::size_t t) {
    const double x = static_cast<double>(t % 40) / 40, y = static_cast<double>(t / 40) / 30;
    return 5.0 + x - 0.5 * y + 2.0 * x * y - 1.5 * y * y;
}

RectifiedImage noisy_parabola(double sigma) {
    support::Random random{11};
    RectifiedImage image;
    for (std::size_t t = 0; t < kCount; ++t) {
        image.value.push_back(static_cast<float>(parabola(t) + sigma * normal_number(random)));
        image.variance.push_back(static_cast<float>(sigma * sigma));
    }
    return image;
}

RectifiedImage even(float value) {
    return {std::vector<float>(kCount, value), std::vector<float>(kCount, 1.0F)};
}

// Proves that noise is averaged and unknown texels are not used: within four predicted sigmas.
TEST(BlockedLight, AParabolaIsFoundInNoise) {
    RectifiedImage image = noisy_parabola(2.0);
    image.value[100] = 1e6F;
    image.variance[100] = kInfinity;
    const BlockedLight light = smooth_light(image, kTexels);
    double mean = 0, worst = 0;
    for (std::size_t t = 0; t < kCount; ++t) {
        mean += parabola(t) / kCount;
        worst = std::max(worst, std::abs(double(light.lux[t]) - parabola(t)));
    }
    EXPECT_NEAR(light.mean_lx, mean, 4 * light.sigma_lx);
    EXPECT_NEAR(light.sigma_lx, 2.0 / std::sqrt(double(kCount)), 0.01);
    EXPECT_NEAR(light.chi_square, 1.0, 0.2);
    EXPECT_LT(worst, 0.8);  // at a corner a parabola is known three times worse than in the mean
}

// Proves that texels beside the screen, which show no light at all, do not bend the parabola.
TEST(BlockedLight, TexelsBesideTheScreenAreLeftOut) {
    RectifiedImage image = noisy_parabola(0.1);
    for (std::size_t t = 0; t < kCount; ++t)
        if (t % 40 < 2 || t / 40 > 27)
            image.value[t] -= static_cast<float>(parabola(t));
    const BlockedLight light = smooth_light(image, kTexels);
    double worst = 0;
    for (std::size_t t = 0; t < kCount; ++t)
        worst = std::max(worst, std::abs(double(light.lux[t]) - parabola(t)));
    EXPECT_LT(worst, 0.06);
    EXPECT_NEAR(light.chi_square, 1.0, 0.2);
}

TEST(BlockedLight, NothingKnownIsRefused) {
    RectifiedImage image = even(1.0F);
    std::fill(image.variance.begin(), image.variance.end(), kInfinity);
    EXPECT_THROW(smooth_light(image, kTexels), Error);
}

// Proves the model: two positions that let a quarter and three quarters of the lamp through a
// filter of peak 0.8 hold back the rest of what the plate holds back.
TEST(MeasuredTexels, TakesOffWhatAPositionHoldsBack) {
    BlockedLight blocked;
    blocked.lux.assign(kCount, 8.0F);
    MeasuredTexels texels(".", kTexels, 2, {blocked}, 1.0, {0.8});
    texels.put(0, {even(25.0F)});
    texels.put(1, {even(75.0F)});
    EXPECT_NEAR(texels.held_back(0, 0), 1 - 0.8 * 0.25, 1e-12);
    EXPECT_NEAR(texels.held_back(0, 1), 1 - 0.8 * 0.75, 1e-12);
    const TileInput tile = texels.read({3, 2});
    ASSERT_EQ(tile.value.size(), 2U * 80U);
    EXPECT_NEAR(tile.value[0], 25.0 - 0.8 * 8.0, 1e-5);
    EXPECT_NEAR(tile.value[80], 75.0 - 0.4 * 8.0, 1e-5);
    EXPECT_EQ(tile.variance[0], 1.0F);
}

TEST(MeasuredTexels, WithoutAPlateNothingIsTakenOff) {
    MeasuredTexels texels(".", kTexels, 1, {}, 1.0, {1.0});
    texels.put(0, {even(3.0F)});
    EXPECT_EQ(texels.read({0, 1}).value[0], 3.0F);
}

}  // namespace
}  // namespace nearfield::fit
