// SPDX-License-Identifier: Apache-2.0
#include "app/bench/arrival.h"

#include "app/bench/target.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::bench {
namespace {

// Proves the interpolation against the closed form of an estimator whose error falls as
// time^-1/2; not that estimators do.
TEST(Arrival, OfAPowerLawIsExactBetweenPoints) {
    std::vector<CostPoint> curve;
    for (const double samples : {10.0, 50.0, 1000.0, 30000.0})
        curve.push_back({2.0 / std::sqrt(samples), 0.3 * samples, samples});
    for (const double error : {0.5, 0.1, 0.0123}) {
        const auto found = arrival(curve, error);
        ASSERT_TRUE(found.has_value());
        const double samples = 4.0 / (error * error);
        EXPECT_NEAR(found->size / samples, 1.0, 1e-9);
        EXPECT_NEAR(found->time_us / (0.3 * samples), 1.0, 1e-9);
        EXPECT_DOUBLE_EQ(found->error_rel, error);
    }
}

// Proves that an error which is reached by luck and lost again does not count, and that what ends
// above the goal never arrives.
TEST(Arrival, CountsOnlyWhereTheErrorStaysBelow) {
    const std::vector<CostPoint> lucky = {{0.5, 1, 1}, {0.05, 2, 2}, {0.4, 4, 4}, {0.04, 8, 8}};
    EXPECT_GT(arrival(lucky, 0.1)->time_us, 4.0);
    EXPECT_FALSE(arrival(lucky, 0.01).has_value());
    EXPECT_FALSE(arrival({}, 0.1).has_value());
}

// Proves the two ends: a first point that is good enough already, and an exact last one, whose
// error has no logarithm.
TEST(Arrival, TakesTheFirstPointOrTheExactOne) {
    const std::vector<CostPoint> curve = {{0.05, 3, 8}, {0.02, 5, 16}, {0.0, 30, 0}};
    EXPECT_DOUBLE_EQ(arrival(curve, 0.1)->time_us, 3.0);
    EXPECT_DOUBLE_EQ(arrival(curve, 0.01)->time_us, 30.0);
}

// Proves the front on points whose order is known by hand, equal points among them.
TEST(ParetoFront, HoldsWhatNoOtherBeats) {
    const std::vector<CostPoint> points = {{0.5, 1, 0}, {0.5, 2, 0},  {0.1, 2, 0},
                                           {0.3, 3, 0}, {0.01, 9, 0}, {0.01, 9, 0}};
    EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, false, true, false, true, true}));
}

// Proves that receivers on a wall lie on a regular grid within the spread of the scattered ones,
// and that receivers at one point still give a wall.
TEST(Wall, SpansTheReceivers) {
    std::vector<model::Receiver> receivers;
    for (int k = 0; k <= 100; ++k)
        receivers.push_back({{0.02 * k - 1.0, 0.01 * k, 1.0 + 0.04 * k}, {0.0, 0.0, -1.0}});
    const Wall wall = wall_of(receivers, {4, 3});
    EXPECT_NEAR(wall.z_m, 3.0, 1e-12);
    EXPECT_NEAR(wall.lower_m.x, -0.96, 1e-12);
    EXPECT_NEAR(wall.upper_m.y, 0.98, 1e-12);
    const std::vector<model::Receiver> grid = receivers_on(wall);
    ASSERT_EQ(grid.size(), 12U);
    EXPECT_NEAR(grid[1].position_m.x - grid[0].position_m.x, 1.92 / 4.0, 1e-12);
    EXPECT_NEAR(grid[4].position_m.y - grid[0].position_m.y, 0.96 / 3.0, 1e-12);

    const std::vector<model::Receiver> one(1);
    EXPECT_GT(wall_of(one, {4, 3}).upper_m.x, wall_of(one, {4, 3}).lower_m.x);
}

}  // namespace
}  // namespace nearfield::bench
