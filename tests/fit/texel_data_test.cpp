// SPDX-License-Identifier: Apache-2.0
// What a measurement is worth: its noise, and what rig and basis get wrong.
#include "fit/texel_data.h"

#include "formats/files/error.h"

#include <gtest/gtest.h>

#include <limits>

namespace nearfield::fit {
namespace {

// One texel, three measurements, the second not known.
TileInput three(float first, float third) {
    return {{first, 1e6F, third}, {1.0F, std::numeric_limits<float>::infinity(), 4.0F}};
}

constexpr TileLayout kLayout{1, 1, 3, 0, 1};

// Proves that the error of rig and basis, 10 % of the brightest known one, is in all weights and is
// told from noise.
TEST(TexelData, TheModelsErrorWeighsAndIsNoNoise) {
    TexelData data;
    ASSERT_TRUE(read_texel(three(30, 75), kLayout, 0, 0, 0, 0.1, data));
    const double error2 = 7.5 * 7.5;
    EXPECT_NEAR(data.weight[0], 1 / (1 + error2), 1e-12);
    EXPECT_EQ(data.weight[1], 0.0);
    EXPECT_NEAR(data.weight[2], 1 / (4 + error2), 1e-12);
    EXPECT_NEAR(data.noise_share[0], 1 / (1 + error2), 1e-12);
    EXPECT_NEAR(data.noise_share[2], 4 / (4 + error2), 1e-12);
    EXPECT_EQ(data.b, (std::vector<double>{30, 0, 75}));
}

TEST(TexelData, InTheDarkThereIsNoiseAlone) {
    TexelData data;
    ASSERT_TRUE(read_texel(three(-3, -1), kLayout, 0, 0, 0, 0.1, data));
    EXPECT_EQ(data.weight[2], 0.25);
    EXPECT_EQ(data.noise_share[2], 1.0);
}

TEST(TexelData, AVarianceThatIsNoneIsRefused) {
    TileInput tile = three(1, 1);
    tile.variance[2] = 0.0F;
    TexelData data;
    EXPECT_THROW(read_texel(tile, kLayout, 0, 0, 0, 0.0, data), Error);
}

}  // namespace
}  // namespace nearfield::fit
