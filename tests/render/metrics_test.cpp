// SPDX-License-Identifier: Apache-2.0
#include "render/metrics.h"

#include "formats/files/error.h"
#include "render/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace nearfield::render {
namespace {

// Proves every figure on numbers small enough to compute by hand; the dark fourth value must not
// count.
TEST(Metrics, RelativeErrorMatchesFiguresByHand) {
    const std::vector<float> reference = {1.0F, 2.0F, 4.0F, 0.003F};
    const std::vector<float> values = {1.1F, 1.6F, 4.0F, 100.0F};
    const RelativeError error = relative_error(values, reference);
    constexpr double kTolerance = 1e-7;  // float inputs
    EXPECT_EQ(error.count, 3U);
    EXPECT_NEAR(error.rms, std::sqrt((0.01 + 0.04) / 3.0), kTolerance);
    EXPECT_NEAR(error.bias, -0.1 / 3.0, kTolerance);
    EXPECT_NEAR(error.p50, 0.1, kTolerance);
    EXPECT_NEAR(error.p95, 0.2, kTolerance);
    EXPECT_NEAR(error.largest, 0.2, kTolerance);
    EXPECT_THROW(relative_error(values, std::vector<float>{1.0F}), Error);
    EXPECT_EQ(relative_error(std::vector<float>{0.0F}, std::vector<float>{0.0F}).count, 0U);
}

// Proves tone mapping and CIELAB on gray, where Delta E is the difference of L*: 1 - e^-1 and 1 -
// e^-2 have L* of 116 cbrt(Y) - 16 = 83.555 and 94.495.
TEST(Metrics, LabDifferenceOfGraysIsTheirLightnessDifference) {
    const std::vector<float> reference = {1, 1, 1, 1, 1, 1}, twice = {2, 2, 2, 2, 2, 2};
    const auto lightness = [](double y) { return 116.0 * std::cbrt(y) - 16.0; };
    const double expected = lightness(1.0 - std::exp(-2.0)) - lightness(1.0 - std::exp(-1.0));
    EXPECT_NEAR(lab_difference(twice, reference), expected, 1e-4);
    EXPECT_EQ(lab_difference(reference, reference), 0.0);
    // Black has L* = 0, by the curve's linear part.
    const std::vector<float> black(6, 0.0F);
    EXPECT_NEAR(lab_difference(black, reference), lightness(1.0 - std::exp(-1.0)), 1e-4);
}

// Proves the color axes: sRGB's red has Lab 53.24, 80.09, 67.20 (published), a distance of 117.34
// from black at equal L.
TEST(Metrics, LabDifferenceOfRedMatchesPublishedCoordinates) {
    // In a frame whose mean makes 1 - exp(-L / mean) of the first pixel red and of its counterpart
    // gray of L* 53.24.
    const double gray_y = std::pow((53.2408 + 16.0) / 116.0, 3.0);
    const float far = 1e9F;  // saturates to 1
    std::vector<float> reference = {far, 0, 0};
    const double mean = 0.2126 * static_cast<double>(far);
    const float gray = static_cast<float>(-mean * std::log(1.0 - gray_y));
    const double red = 1.0 - std::exp(-1.0 / 0.2126);  // not quite 1: one pixel is its own frame
    EXPECT_NEAR(red, 0.99, 0.01);
    EXPECT_NEAR(lab_difference(std::vector<float>{gray, gray, gray}, reference),
                std::hypot(80.09, 67.20), 0.7);
}

// Proves that pixels the reference does not light are left out.
TEST(Metrics, LabDifferenceSkipsUnlitPixels) {
    const std::vector<float> reference = {1, 1, 1, 0, 0, 0};
    EXPECT_EQ(lab_difference(std::vector<float>{1, 1, 1, 5, 5, 5}, reference), 0.0);
    EXPECT_EQ(lab_difference(std::vector<float>{0, 0, 0}, std::vector<float>{0, 0, 0}), 0.0);
}

// Proves that a picture's error layer is what its luminances say, and dark where the reference is.
TEST(Metrics, ComparedPicturesGetTheirErrorAsALayer) {
    const auto picture = [](const std::vector<float>& gray) {
        Picture made{{static_cast<int>(gray.size()), 1}, {{"", {"R", "G", "B"}, {}}}, {}};
        for (const float value : gray)
            made.layers[0].values.insert(made.layers[0].values.end(), 3, value);
        return made;
    };
    Picture found = picture({1.1F, 1.6F, 4.0F, 100.0F});
    const Picture reference = picture({1.0F, 2.0F, 4.0F, 0.003F});
    const Comparison comparison = compare_pictures(found, reference);
    ASSERT_EQ(found.layers.size(), 2U);
    EXPECT_EQ(found.layers[1].name, "error");
    constexpr float kTolerance = 1e-6F;
    const float expected[] = {0.1F, -0.2F, 0.0F, 0.0F};
    for (std::size_t k = 0; k < 4; ++k)
        EXPECT_NEAR(found.layers[1].values[k], expected[k], kTolerance);
    EXPECT_EQ(comparison.radiance_y.count, 3U);
    EXPECT_NEAR(comparison.radiance_y.largest, 0.2, 1e-6);
    EXPECT_GT(comparison.lab, 0.0);
    EXPECT_NE(summary(comparison).find("largest 20 %"), std::string::npos) << summary(comparison);

    Picture small = picture({1.0F});
    EXPECT_THROW(compare_pictures(small, reference), Error);
    Picture empty{{4, 1}, {}, {}};
    EXPECT_THROW(compare_pictures(empty, reference), Error);
}

}  // namespace
}  // namespace nearfield::render
