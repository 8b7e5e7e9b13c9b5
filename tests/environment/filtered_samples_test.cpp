// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/filtered_samples.glsl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace nearfield {
namespace {

// Proves that 2^k points are a net: one in each of 2^k equal rectangles of every shape.
TEST(FilteredSamples, HammersleysSetIsANet) {
    constexpr shared::uint kBits = 8, kCount = 1U << kBits;
    for (shared::uint across = 0; across <= kBits; ++across) {
        std::set<shared::uint> cells;
        for (shared::uint i = 0; i < kCount; ++i) {
            const glm::vec2 point = shared::hammersley_point(i, kCount);
            EXPECT_TRUE(point.x > 0.0F && point.x < 1.0F && point.y >= 0.0F && point.y < 1.0F);
            cells.insert(static_cast<shared::uint>(point.x * static_cast<float>(1U << across)) *
                             (kCount >> across) +
                         static_cast<shared::uint>(point.y * static_cast<float>(kCount >> across)));
        }
        EXPECT_EQ(cells.size(), kCount) << across;
    }
}

// Proves the levels by counting texels: at level l one of them covers 4^l of the finest, which FIS
// makes four times a sample's share and Gems too where that is a texel at least; below, Gems stays
// one level up and FIS goes down.
TEST(FilteredSamples, LevelsCoverASamplesShare) {
    // A uniform density over the sphere on a map of equal areas, 256 x 256 texels for 4 pi.
    const float uniform = 1.0F / 12.5663706F, sr_per_area = 12.5663706F;
    const auto share = [&](float count) {
        return shared::texels_per_sample(65536.0F, count, uniform, sr_per_area);
    };
    EXPECT_NEAR(share(1.0F), 65536.0F, 0.1F);
    EXPECT_NEAR(share(64.0F), 1024.0F, 1e-2F);
    EXPECT_NEAR(shared::filter_level(shared::kLevelFis, share(64.0F)), 6.0F, 1e-5F);
    EXPECT_NEAR(shared::filter_level(shared::kLevelGems, share(64.0F)), 6.0F, 1e-5F);
    EXPECT_EQ(shared::filter_level(shared::kLevelNone, share(64.0F)), 0.0F);
    EXPECT_NEAR(shared::filter_level(shared::kLevelFis, 0.5F), 0.5F, 1e-6F);
    EXPECT_NEAR(shared::filter_level(shared::kLevelGems, 0.5F), 1.0F, 1e-6F);
    EXPECT_EQ(shared::filter_level(shared::kLevelFis, 0.01F), 0.0F);
    // Twice the density, half the texels, half a level.
    EXPECT_NEAR(shared::filter_level(shared::kLevelFis, share(64.0F)) -
                    shared::filter_level(shared::kLevelFis, 0.5F * share(64.0F)),
                0.5F, 1e-5F);
}

// Proves linear interpolation: exact for a plane between the outer texels' centers, constant
// beyond, and on a map of one texel.
TEST(FilteredSamples, TapsInterpolateAPlane) {
    constexpr int kSide = 8;
    const auto value = [](int column, int row) {
        return 2.0F * static_cast<float>(column) - 3.0F * static_cast<float>(row);
    };
    for (const glm::vec2 at : {glm::vec2(0.5F), glm::vec2(0.1F, 0.9F), glm::vec2(0.33F, 0.77F)}) {
        const shared::LinearTaps taps = shared::linear_taps(at, kSide);
        const float mixed = glm::mix(
            glm::mix(value(taps.low.x, taps.low.y), value(taps.high.x, taps.low.y), taps.part.x),
            glm::mix(value(taps.low.x, taps.high.y), value(taps.high.x, taps.high.y), taps.part.x),
            taps.part.y);
        EXPECT_NEAR(mixed, 2.0F * (at.x * kSide - 0.5F) - 3.0F * (at.y * kSide - 0.5F), 1e-5F);
    }
    for (const int side : {1, 8})
        for (const float end : {0.0F, 1.0F}) {
            const shared::LinearTaps taps = shared::linear_taps(glm::vec2(end), side);
            EXPECT_GE(taps.low.x, 0);
            EXPECT_LT(taps.high.y, side);
            EXPECT_NEAR(static_cast<float>(taps.low.x) + taps.part.x,
                        end * static_cast<float>(side - 1), 1e-6F);
        }
}

}  // namespace
}  // namespace nearfield
