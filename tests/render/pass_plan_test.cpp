// SPDX-License-Identifier: Apache-2.0
#include "render/pass_plan.h"

#include "render/options.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::render {
namespace {

// Proves that costs of two trials are split into what a pass takes and what a sample takes, and
// that noise in their times never makes either negative.
TEST(PassPlan, CostIsTheLineThroughTwoTrials) {
    const PassCost cost = cost_from(8, 0.7 + 8 * 0.02, 24, 0.7 + 24 * 0.02);
    EXPECT_NEAR(cost.fixed_s, 0.7, 1e-12);
    EXPECT_NEAR(cost.per_sample_s, 0.02, 1e-12);
    EXPECT_NEAR(cost.of(100), 2.7, 1e-12);
    const PassCost noisy = cost_from(8, 0.5, 24, 0.4);
    EXPECT_EQ(noisy.per_sample_s, 0.0);
    EXPECT_EQ(noisy.fixed_s, 0.5);
    EXPECT_EQ(cost_from(8, 0.1, 24, 0.5).fixed_s, 0.0);
}

// Proves that passes towards an error that falls as samples^-rate end at it, without drawing much
// more than it takes, for the slowest rate there is and for a stratified one.
TEST(PassPlan, PassesReachTheErrorWithoutDrawingMuchMore) {
    for (const double rate : {0.5, 0.75})
        for (const double wanted : {0.2, 0.03, 0.01, 0.002}) {
            const auto error = [&](int drawn) { return 0.5 * std::pow(drawn, -rate); };
            int drawn = 16, passes = 1;
            while (const int next = samples_for_error(error(drawn), wanted, drawn)) {
                drawn += next;
                ASSERT_LT(++passes, 12);
            }
            EXPECT_LE(error(drawn), wanted);
            const double needed = std::pow(0.5 / wanted, 1.0 / rate);
            EXPECT_LE(drawn, std::max(16.0, 4.0 * needed)) << rate << " " << wanted;
        }
}

// Proves that nothing is drawn where the error is reached, or can never be.
TEST(PassPlan, NothingIsDrawnForAnErrorThatIsReachedOrOutOfReach) {
    EXPECT_EQ(samples_for_error(0.01, 0.01, 64), 0);
    EXPECT_EQ(samples_for_error(0.01, 0.0, 64), 0);
    EXPECT_EQ(samples_for_error(0.01, -0.1, 64), 0);
    EXPECT_EQ(samples_for_error(0.0101, 0.01, 64), 16);
    EXPECT_EQ(samples_for_error(10.0, 0.01, 64), 192);
}

// Proves that a pass planned for a time takes no more than that.
TEST(PassPlan, APassFitsTheTimeThatIsLeft) {
    const PassCost cost{0.3, 0.01};
    EXPECT_EQ(samples_within(cost, 0.3), 0);
    EXPECT_EQ(samples_within(cost, 0.1), 0);
    for (const double left_s : {0.32, 0.5, 1.0, 17.0}) {
        const int samples = samples_within(cost, left_s);
        EXPECT_LE(cost.of(samples), left_s);
        EXPECT_GT(cost.of(samples + 2), left_s);
    }
    EXPECT_EQ(samples_within({0.3, 0.0}, 1.0), kMostSamples);
}

}  // namespace
}  // namespace nearfield::render
