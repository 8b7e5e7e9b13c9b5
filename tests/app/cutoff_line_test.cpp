// SPDX-License-Identifier: Apache-2.0
#include "app/cutoff_line.h"

#include "sample_data/headlight.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::app {
namespace {

// Proves the place on a step that is known: a logistic fall of log E is steepest in its middle,
// wherever that lies between the steps of the scan.
TEST(CutoffLine, IsWhereLightFallsFastest) {
    for (const double middle_deg : {-0.573, 0.0, 0.31, 1.234}) {
        const BeamScan scan = [&](double /*tangent_x*/, double tangent_y) {
            const double above = (glm::degrees(std::atan(tangent_y)) - middle_deg) / 0.1;
            return std::exp(3.0 - 3.0 * std::tanh(above));
        };
        const auto found = gradient_tangent(scan, 0.1);
        ASSERT_TRUE(found);
        EXPECT_NEAR(glm::degrees(std::atan(*found)), middle_deg, 0.004) << middle_deg;
    }
}

// Proves that blur moves the edge by a tenth of what it moves the gradient.
TEST(CutoffLine, BlurHardlyMovesTheEdge) {
    const auto blurred = [](double width_deg) -> BeamScan {
        return [width_deg](double /*tangent_x*/, double tangent_y) {
            const double at_deg = glm::degrees(std::atan(tangent_y)) - 0.31;
            // A beam exp(3 - 0.2 x) that ends at x = 0, with an even floor, through a gaussian.
            const double variance = width_deg * width_deg;
            return 0.1 + 0.5 * std::exp(3 - 0.2 * at_deg + 0.02 * variance) *
                             std::erfc((at_deg - 0.2 * variance) / (width_deg * std::sqrt(2.0)));
        };
    };
    const auto degrees = [](const std::optional<double>& tangent) {
        EXPECT_TRUE(tangent);
        return glm::degrees(std::atan(tangent.value_or(1.0)));
    };
    const double sharp_deg = degrees(edge_tangent(blurred(0.03), 0.0));
    EXPECT_NEAR(sharp_deg, 0.31, 0.01);
    EXPECT_NEAR(degrees(edge_tangent(blurred(0.2), 0.0)), sharp_deg, 0.01);
    EXPECT_NEAR(degrees(edge_tangent(blurred(0.3), 0.0)), sharp_deg, 0.05);
    EXPECT_GT(degrees(gradient_tangent(blurred(0.3), 0.0)), 0.31 + 0.3);
}

TEST(CutoffLine, DarknessHasNone) {
    EXPECT_FALSE(edge_tangent([](double, double) { return 0.0; }, 0.0));
    EXPECT_FALSE(gradient_tangent([](double, double) { return 0.0; }, 0.0));
}

// Proves that it is the headlight's own line, level on the left and rising on the right: the
// steepest fall of log E is in the upper half of the formula's step, which is 0.33 degrees wide in
// green and 0.6 in blue.
TEST(CutoffLine, FindsTheHeadlights) {
    const sample_data::Headlight headlight = sample_data::make_headlight();
    const BeamScan scan = [&](double x, double y) {
        return model::luminance(sample_data::intensity(headlight, {x, y, 1.0}));
    };
    const auto above_step_deg = [&](double tangent_x, double step) {
        const auto line = gradient_tangent(scan, tangent_x);
        EXPECT_TRUE(line) << tangent_x;
        return glm::degrees(std::atan(line.value_or(1.0)) - std::atan(step));
    };
    const double level = above_step_deg(0.15, sample_data::kCutoffTangent);
    const double raised =
        above_step_deg(-0.1, sample_data::kCutoffTangent + std::tan(glm::radians(15.0)) * 0.1);
    EXPECT_GT(level, 0.0);
    EXPECT_LT(level, 0.3);
    EXPECT_NEAR(raised, level, 0.05);
}

}  // namespace
}  // namespace nearfield::app
