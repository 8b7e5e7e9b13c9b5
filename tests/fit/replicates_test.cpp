// SPDX-License-Identifier: Apache-2.0
// Replicates' measurements: noise of the right size, and a bench as uncertain as its rig says.
#include "fit/replicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

TEST(Replicates, NoiseHasTheVarianceOfItsMeasurement) {
    const TileLayout layout{50, 40, 3, 0, 2};
    TileInput tile;
    tile.value.assign(50 * 40 * 3 * 2, 7.0F);
    tile.variance.assign(tile.value.size(), 4.0F);
    tile.variance[5] = std::numeric_limits<float>::infinity();
    const TileInput before = tile;
    add_noise(layout, {10, 40}, {1, 3}, tile);
    double sum = 0, square = 0;
    for (const float value : tile.value) {
        sum += double(value) - 7.0;
        square += std::pow(double(value) - 7.0, 2.0);
    }
    const auto count = static_cast<double>(tile.value.size());
    EXPECT_EQ(tile.value[5], 7.0F);
    EXPECT_NEAR(sum / count, 0.0, 4 * 2.0 / std::sqrt(count));
    EXPECT_NEAR(square / count, 4.0, 4 * 4.0 * std::sqrt(2 / count));

    // A row by itself gets the same numbers.
    const TileLayout one_row{50, 1, 3, 0, 2};
    TileInput row;
    row.value.assign(50 * 3 * 2, 7.0F);
    row.variance.assign(row.value.size(), 4.0F);
    add_noise(one_row, {12, 1}, {1, 3}, row);
    EXPECT_EQ(row.value[one_row.at(1, 2, 3, 0, 17)], tile.value[layout.at(1, 2, 3, 2, 17)]);
    TileInput other = before;
    add_noise(layout, {10, 40}, {1, 4}, other);
    EXPECT_NE(other.value[9], tile.value[9]);
}

// A rig whose distance and step along x are known to 1 mm and 0.1 mm, and rise and fall together.
rig::Rig uncertain_rig() {
    rig::Rig rig;
    rig.planes = rig::Planes{};
    rig.planes->pitch_m = {0.02, 0.02};
    rig.covariance_of = {"fx_px", "delta_m", "pitch_x_m"};
    rig.covariance = {4.0, 0, 0, 0, 1e-6, 0.5e-7, 0, 0.5e-7, 1e-8};
    return rig;
}

// Proves sizes and correlation by 4000 draws, 4 sigma.
TEST(Replicates, PlacesAreAsUncertainAsTheRigSays) {
    constexpr int kDraws = 4000;
    const rig::Rig rig = uncertain_rig();
    Optics optics;
    optics.position_m = {{0, 0, -0.2}, {0.06, 0.04, -0.2}};
    double delta2 = 0, pitch2 = 0, product = 0;
    for (int r = 0; r < kDraws; ++r) {
        const Optics drawn = drawn_optics(optics, rig, {7, static_cast<std::uint32_t>(r)});
        const double delta_m = -(drawn.position_m[0].z - optics.position_m[0].z);
        const double pitch_m = (drawn.position_m[1].x - optics.position_m[1].x) / 3;
        EXPECT_EQ(drawn.position_m[0].x, 0.0);
        EXPECT_EQ(drawn.position_m[1].y, 0.04);
        delta2 += delta_m * delta_m / kDraws;
        pitch2 += pitch_m * pitch_m / kDraws;
        product += delta_m * pitch_m / kDraws;
    }
    const double few = 4 * std::sqrt(2.0 / kDraws);
    EXPECT_NEAR(delta2 / 1e-6, 1.0, few);
    EXPECT_NEAR(pitch2 / 1e-8, 1.0, few);
    EXPECT_NEAR(product / 1e-7, 0.5, few);
}

TEST(Replicates, WithoutACovariancePlacesStay) {
    rig::Rig rig = uncertain_rig();
    rig.covariance_of.clear();
    rig.covariance.clear();
    Optics optics;
    optics.position_m = {{0.06, 0.04, -0.2}};
    EXPECT_EQ(drawn_optics(optics, rig, {1, 1}).position_m[0], optics.position_m[0]);
}

}  // namespace
}  // namespace nearfield::fit
