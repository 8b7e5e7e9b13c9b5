// SPDX-License-Identifier: Apache-2.0
// Which part of S is fitted, before a camera that looks straight at it.
#include "fit/texel_plan.h"

#include "formats/files/error.h"
#include "tests/fit/straight_bench.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::fit {
namespace {

constexpr double kOf = 1e-6;  // m; the search halves thirty times

// Proves the extent against what the camera's own numbers say: its picture's size on S.
TEST(TexelPlan, AllThatTheCameraSeesIsVisible) {
    const StraightBench bench;
    const Extent extent = visible_extent(straight_rig(bench));
    EXPECT_NEAR(extent.min_m.x, -0.096, kOf);
    EXPECT_NEAR(extent.max_m.x, 0.096, kOf);
    EXPECT_NEAR(extent.min_m.y, -0.072, kOf);
    EXPECT_NEAR(extent.max_m.y, 0.072, kOf);
}

// Proves that a turned camera's extent is seen as a whole: its picture cuts the corners.
TEST(TexelPlan, ATurnedPictureHoldsTheExtent) {
    rig::Rig rig = straight_rig({});
    const double angle = 0.3;
    rig.planes->camera_from_slab.rotation =
        glm::dmat3(std::cos(angle), std::sin(angle), 0, -std::sin(angle), std::cos(angle), 0, 0, 0,
                   1) *
        rig.planes->camera_from_slab.rotation;
    const Extent extent = visible_extent(rig);
    for (const glm::dvec2 corner_m :
         {extent.min_m, extent.max_m, glm::dvec2(extent.min_m.x, extent.max_m.y),
          glm::dvec2(extent.max_m.x, extent.min_m.y)})
        EXPECT_TRUE(seen_px(rig, corner_m));
    EXPECT_GT((extent.max_m - extent.min_m).x, 0.1);
}

TEST(TexelPlan, ACameraThatLooksAwayIsRefused) {
    rig::Rig rig = straight_rig({});
    rig.planes->camera_from_slab.translation_m.z = -0.5;
    EXPECT_THROW(visible_extent(rig), Error);
}

// Proves the lit part, with its margin of 3 %, that pixels that are not known are dark, and that
// single bright pixels, as noise and hot ones, are no light.
TEST(TexelPlan, TheLitPartIsFound) {
    const StraightBench bench;
    const rig::Rig rig = straight_rig(bench);
    std::vector<float> light(48 * 36, 0.001F);
    for (int y = 12; y < 20; ++y)
        for (int x = 8; x < 28; ++x)
            light[static_cast<std::size_t>(y * 48 + x)] = 1.0F;
    light[0] = std::nanf("");
    light[48 * 33 + 5] = light[48 * 2 + 45] = 0.7F;
    for (int y = 28; y < 32; ++y)
        for (int x = 40; x < 44; ++x)
            light[static_cast<std::size_t>(y * 48 + x)] = 0.7F;
    const Extent extent = lit_extent(rig, visible_extent(rig), light, 0.01);
    // Edges of the outermost lit pixels; rows count from the top.
    const glm::dvec2 low(0.004 * (8 - 24), 0.004 * (18 - 20));
    const glm::dvec2 high(0.004 * (28 - 24), 0.004 * (18 - 12));
    const glm::dvec2 margin = 0.03 * (high - low);
    EXPECT_LT(glm::length(extent.min_m - (low - margin)), 1e-9);
    EXPECT_LT(glm::length(extent.max_m - (high + margin)), 1e-9);
    EXPECT_THROW(lit_extent(rig, visible_extent(rig), std::vector<float>(48 * 36, -1.0F), 0.01),
                 Error);
}

TEST(TexelPlan, TexelsAreAsLargeAsPixels) {
    rig::Rig rig = straight_rig({});
    const Extent extent{{-0.04, -0.02}, {0.04, 0.04}};
    EXPECT_EQ(matching_texels(rig, extent, 512), glm::ivec2(20, 15));
    EXPECT_EQ(matching_texels(rig, extent, 16), glm::ivec2(16, 15));
    rig.radiometry->mosaic = "rggb";
    EXPECT_EQ(matching_texels(rig, extent, 512), glm::ivec2(10, 8));
}

}  // namespace
}  // namespace nearfield::fit
