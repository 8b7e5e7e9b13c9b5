// SPDX-License-Identifier: Apache-2.0
#include "render/display.h"

#include "formats/files/error.h"
#include "formats/shared/tonemap.glsl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

Picture flat(std::vector<float> rgb) {
    Picture picture;
    picture.size_px = {static_cast<int>(rgb.size() / 3), 1};
    picture.layers = {{"", {"R", "G", "B"}, std::move(rgb)}};
    return picture;
}

// Proves the papers' operator, exposure and the sRGB curve by hand: 1 - e^-1 = 0.6321 is 208.2 of
// 255 in sRGB.
TEST(Display, PapersOperatorGivesTheValuesComputedByHand) {
    const Picture picture = flat({2, 2, 2, 4, 4, 4, 0, 0, 0});
    const Display automatic = display(picture, {ToneMap::Papers, {}});
    EXPECT_NEAR(automatic.exposure_ev, std::log2(2.0 / 1.2), 1e-6);
    EXPECT_EQ(automatic.srgb, (std::vector<unsigned char>{208, 208, 208, 239, 239, 239, 0, 0, 0}));
    EXPECT_EQ(display(picture, {ToneMap::Papers, automatic.exposure_ev}).srgb, automatic.srgb);
}

// Proves the filmic curve's documented anchor values.
TEST(Display, FilmicCurveHasItsDocumentedValues) {
    EXPECT_NEAR(shared::filmic_curve(0.18F), 0.2669, 1e-4);
    EXPECT_NEAR(shared::filmic_curve(1.0F), 0.8038, 1e-4);
    EXPECT_EQ(shared::filmic_curve(7.3F), 1.0F);
    EXPECT_EQ(shared::filmic_curve(0.0F), 0.0F);
    for (float y = 0.0F; y < 8.0F; y += 0.01F)
        EXPECT_LE(shared::filmic_curve(y), shared::filmic_curve(y + 0.01F));
}

// Proves that luminance goes along the curve and that hue stays: channels keep their order and,
// where the display allows, their ratios.
TEST(Display, FilmicKeepsHueAndStaysWithinTheDisplay) {
    const glm::vec3 dim = shared::tonemap_filmic({0.1F, 0.2F, 0.05F});
    EXPECT_NEAR(dim.x / dim.y, 0.5, 1e-6);
    EXPECT_NEAR(dim.z / dim.y, 0.25, 1e-6);
    for (const float scale : {1.0F, 10.0F, 1e4F, 1e30F}) {
        const glm::vec3 red = shared::tonemap_filmic(glm::vec3(1.0F, 0.1F, 0.0F) * scale);
        EXPECT_NEAR(shared::luminance709(red), shared::filmic_curve(0.28412F * scale), 1e-5);
        EXPECT_LE(red.x, 1.0F);
        EXPECT_GE(red.x, red.y);
        EXPECT_GE(red.y, red.z);
        EXPECT_GE(red.z, 0.0F);
    }
    EXPECT_EQ(shared::tonemap_filmic(glm::vec3(0.0F)), glm::vec3(0.0F));
}

// Proves that automatic exposure looks at lit pixels alone, and that a dark picture is no special
// case.
TEST(Display, AutomaticExposurePutsTheBrightestTwentiethAboveWhite) {
    std::vector<float> rgb(std::size_t{3} * 1000, 0.0F);
    for (std::size_t pixel = 0; pixel < 100; ++pixel)  // 100 lit pixels of 1 ... 100
        std::fill_n(rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel), 3,
                    static_cast<float>(pixel + 1));
    const double ev = automatic_exposure_ev(flat(rgb).layers[0], ToneMap::Filmic);
    EXPECT_NEAR(1.2 * std::exp2(ev), 95.0, 1e-3);
    EXPECT_EQ(automatic_exposure_ev(flat({0, 0, 0}).layers[0], ToneMap::Filmic), 0.0);
    EXPECT_EQ(display(flat({0, 0, 0}), {}).srgb, (std::vector<unsigned char>{0, 0, 0}));
    Picture empty;
    EXPECT_THROW(display(empty, {}), Error);
}

}  // namespace
}  // namespace nearfield::render
