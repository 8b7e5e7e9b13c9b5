// SPDX-License-Identifier: Apache-2.0
#include "sample_data/headlight.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::sample_data {
namespace {

// Intensity's Y; right and up in degrees as the driver sees them: +x of the luminaire is to his
// left.
double intensity_cd(const Headlight& headlight, double right_deg, double up_deg) {
    const double degree = std::acos(-1.0) / 180.0;
    return model::luminance(
        intensity(headlight, {-std::tan(right_deg * degree), std::tan(up_deg * degree), 1.0}));
}

TEST(Headlight, FluxIs1000LmForEverySeed) {
    // Proves the normalization, not the quadrature: ProjectionTest's flux comes from another one.
    constexpr double kTolerance = 1e-9;  // the same sum, scaled once
    for (const std::uint64_t seed : {1U, 7U}) {
        EXPECT_NEAR(model::luminance(flux(make_headlight(seed))), 1000.0, 1000.0 * kTolerance);
    }
}

TEST(Headlight, PeakIsThatOfALowBeamAndLiesBelowTheCutOff) {
    // Proves the hot spot's place and size on a grid of directions.
    const Headlight headlight = make_headlight();
    double peak_cd = 0.0, at_up_deg = 0.0;
    for (double up = -6.0; up <= 3.0; up += 0.5) {
        for (double right = -8.0; right <= 8.0; right += 1.0) {
            const double value_cd = intensity_cd(headlight, right, up);
            if (value_cd > peak_cd) {
                peak_cd = value_cd;
                at_up_deg = up;
            }
        }
    }
    EXPECT_GT(peak_cd, 30000.0);
    EXPECT_LT(peak_cd, 40000.0);
    EXPECT_LT(at_up_deg, -0.57);
}

TEST(Headlight, CutOffIsSharpOnTheLeftAndRisesOnTheRight) {
    // Proves the kink's side and height: 1 degree up is dark on the left and bright 8 degrees
    // right, where the line is at atan(-0.010 + 0.268 * 0.141) = 1.6 degrees.
    const Headlight headlight = make_headlight();
    EXPECT_LT(intensity_cd(headlight, -4.0, 1.0), 200.0);
    EXPECT_GT(intensity_cd(headlight, -4.0, -1.5), 100.0 * intensity_cd(headlight, -4.0, 1.0));
    EXPECT_GT(intensity_cd(headlight, 8.0, 1.0), 20.0 * intensity_cd(headlight, -8.0, 1.0));
    EXPECT_LT(intensity_cd(headlight, 8.0, 2.5), 0.1 * intensity_cd(headlight, 8.0, 1.0));
}

TEST(Headlight, CutOffHasABlueFringeAboveAndAWarmOneBelow) {
    // Through the lens' center, where the aim's distance does not matter; well below, the lamp's
    // own white.
    const Headlight headlight = make_headlight();
    const auto blue_to_red = [&](double above_tangent) {
        const glm::dvec3 rgb =
            radiance(headlight, {0.0, 0.0}, {0.05, kCutoffTangent + above_tangent});
        return rgb.b / rgb.r;
    };
    const double white = blue_to_red(-0.02);
    EXPECT_GT(blue_to_red(0.003), 1.5 * white);
    EXPECT_LT(blue_to_red(-0.002), 0.95 * white);
}

TEST(Headlight, IsDarkOutsideLensAndBeam) {
    // Exactly zero, on the lens' rim and on each side of the window.
    const Headlight headlight = make_headlight();
    const glm::dvec2 forward(0.0, -0.03);
    EXPECT_GT(model::luminance(radiance(headlight, {0.0799, 0.0}, forward)), 0.0);
    EXPECT_EQ(radiance(headlight, {0.0801, 0.0}, forward), glm::dvec3(0.0));
    EXPECT_EQ(radiance(headlight, {0.0, -0.0651}, forward), glm::dvec3(0.0));
    EXPECT_EQ(radiance(headlight, {0.06, 0.05}, forward), glm::dvec3(0.0));
    for (const glm::dvec2 tangent :
         {glm::dvec2(0.63, -0.05), {-0.63, -0.05}, {0.0, 0.062}, {0.0, -0.223}}) {
        EXPECT_EQ(radiance(headlight, {0.0, 0.0}, tangent), glm::dvec3(0.0));
    }
}

TEST(Headlight, IrradianceFarAwayIsIntensityOverSquare) {
    // Proves that the two quadratures of the same formula agree where they must. At 1 km the lens'
    // parallax is 8e-5 of a tangent, 2 % of the cut-off's width, so directions away from the
    // cut-off are asked.
    constexpr double kTolerance = 1e-3;
    const Headlight headlight = make_headlight();
    for (const glm::dvec2 tangent : {glm::dvec2(0.02, -0.05), {-0.2, -0.03}, {0.3, -0.1}}) {
        const glm::dvec3 direction = glm::normalize(glm::dvec3(tangent, 1.0));
        const glm::dvec3 lux = irradiance(headlight, {1000.0 * direction, -direction});
        const double candela = model::luminance(intensity(headlight, direction));
        EXPECT_NEAR(model::luminance(lux) * 1e6, candela, kTolerance * candela);
    }
}

}  // namespace
}  // namespace nearfield::sample_data
