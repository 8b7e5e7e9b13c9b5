// SPDX-License-Identifier: Apache-2.0
// The distance from which a lamp is a point, against the closed form of a Lambertian square.
#include "formats/farfield/near_far.h"

#include "formats/files/error.h"
#include "formats/model/profile.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield {
namespace {

constexpr double kSide_m = 0.2;

// Radiance 1 out of a square on U, whatever the direction, as far as S reaches.
LightField lambertian_square() {
    Slab slab;
    slab.delta_m = 0.5;
    slab.grid = {1, 1};
    slab.pitch_m = glm::dvec2(kSide_m);
    slab.texels = {40, 40};
    slab.s_max_m = glm::dvec2(1);
    slab.s_min_m = -slab.s_max_m;
    slab.profile = model::make_profile("box");
    slab.weighting = Weighting::Radiance;
    slab.coeffs.assign(slab.texel_count(), 1.0F);
    LightField lamp;
    lamp.slabs = {slab};
    return lamp;
}

// On the axis: E = 4 u atan u with u = h / sqrt(r^2 + h^2), h half the side; I = (2 h)^2.
double point_error(double r_m) {
    const double h = kSide_m / 2, u = h / std::hypot(r_m, h);
    return 4 * h * h / (r_m * r_m) / (4 * u * std::atan(u)) - 1;
}

TEST(NearFar, OfALambertianSquareIsTheClosedForm) {
    farfield::NearFarOptions options;
    options.size = 3;
    options.half_angle_deg = 20;
    const farfield::NearFarMap map = farfield::near_far_map(lambertian_square(), options);
    EXPECT_LT(glm::length(map.center_m - glm::dvec3(0, 0, -0.5)), 0.01 * kSide_m);
    EXPECT_NEAR(map.lamp_size_m, std::sqrt(2) * kSide_m, 1e-12);
    constexpr std::size_t kMiddle = 4;
    EXPECT_NEAR(map.intensity[kMiddle], kSide_m * kSide_m, 1e-6);
    for (std::size_t k = 0; k < map.errors.size(); ++k) {
        const double distance_m = map.distance_m[k][kMiddle];
        // Errors fall as 1 / r^2, a straight line in logarithms, bent by its next term, (h / r)^2,
        // and shifted with the center, which is known from 4096 rays.
        EXPECT_NEAR(point_error(distance_m), map.errors[k], 0.05 * map.errors[k])
            << distance_m << " m";
    }
    EXPECT_GT(map.distance_m[0][kMiddle], 2 * map.distance_m[1][kMiddle]);
}

TEST(NearFar, DarkDirectionsAreLeftOut) {
    LightField lamp = lambertian_square();
    Slab& slab = lamp.slabs[0];
    for (std::size_t t = 0; t < slab.texel_count(); ++t)
        if (t % 40 < 24)  // S is dark for x < 0.2 m
            slab.coeffs[t] = 0;
    farfield::NearFarOptions options;
    options.size = 5;
    options.half_angle_deg = 40;
    const farfield::NearFarMap map = farfield::near_far_map(lamp, options);
    EXPECT_TRUE(std::isnan(map.distance_m[0][10]));
    EXPECT_FALSE(std::isnan(map.distance_m[0][14]));
}

TEST(NearFar, RefusesOptionsOutOfRange) {
    farfield::NearFarOptions options;
    options.size = 4;
    EXPECT_THROW(farfield::near_far_map(lambertian_square(), options), Error);
    options.size = 5;
    options.half_angle_deg = 90;
    EXPECT_THROW(farfield::near_far_map(lambertian_square(), options), Error);
}

}  // namespace
}  // namespace nearfield
