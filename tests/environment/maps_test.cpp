// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/environment_maps.glsl.h"
#include "tests/environment/skies.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield {
namespace {

glm::vec3 random_direction(support::Random& random) {
    const double z = random.uniform(-1.0, 1.0),
                 azimuth = random.uniform(0.0, 2.0 * std::acos(-1.0));
    const double across = std::sqrt(1.0 - z * z);
    return glm::dvec3(across * std::cos(azimuth), across * std::sin(azimuth), z);
}

// Proves the frame that CONVENTIONS.md states, and that both ways undo each other.
TEST(EnvironmentMaps, LatLongIsWhatACameraSees) {
    const auto at = [](glm::vec3 direction) { return shared::latlong_from_direction(direction); };
    EXPECT_LT(glm::distance(at({0, 0, -1}), {0.5F, 0.5F}), 1e-6F);
    EXPECT_LT(glm::distance(at({1, 0, 0}), {0.75F, 0.5F}), 1e-6F);
    EXPECT_LT(glm::distance(at({-1, 0, 0}), {0.25F, 0.5F}), 1e-6F);
    EXPECT_NEAR(at({0, 1, 0}).y, 0.0F, 1e-6F);
    EXPECT_NEAR(at({0, -1, 0}).y, 1.0F, 1e-6F);
    support::Random random{1};
    for (int k = 0; k < 10000; ++k) {
        const glm::vec3 d = random_direction(random);
        EXPECT_LT(glm::distance(shared::direction_from_latlong(at(d)), d), 2e-6F);
    }
}

// Proves that both ways undo each other, on each side and into the rim beyond the seam, and that
// every direction stands well within its map: coarser levels have something around it.
TEST(EnvironmentMaps, ParaboloidsHoldEveryDirection) {
    support::Random random{2};
    for (int k = 0; k < 10000; ++k) {
        const glm::vec3 d = random_direction(random);
        const shared::ParaboloidPoint point = shared::paraboloid_from_direction(d);
        EXPECT_EQ(point.side, d.z >= 0.0F ? 0 : 1);
        EXPECT_LT(glm::distance(shared::direction_from_paraboloid(point.side, point.at), d), 1e-6F);
        const float to_rim =
            std::min({point.at.x, point.at.y, 1.0F - point.at.x, 1.0F - point.at.y});
        EXPECT_GT(to_rim, 0.5F * (1.0F - 1.0F / 1.2F) - 1e-6F);
    }
    // Of the rim: unit length, and beyond the seam.
    for (const glm::vec2 at : {glm::vec2(0.0F), glm::vec2(1.0F, 0.5F), glm::vec2(0.2F, 1.0F)}) {
        EXPECT_NEAR(glm::length(shared::direction_from_paraboloid(0, at)), 1.0F, 1e-6F);
        EXPECT_LT(shared::direction_from_paraboloid(0, at).z, 0.0F);
        EXPECT_GT(shared::direction_from_paraboloid(1, at).z, 0.0F);
    }
}

// Proves the Jacobian against the area that a small square of the map spans on the sphere, and by
// the whole: the map's half space is 2 pi.
TEST(EnvironmentMaps, SolidAngleIsTheJacobian) {
    support::Random random{3};
    constexpr float kStep = 1e-3F;
    for (int k = 0; k < 1000; ++k) {
        const glm::vec3 d = random_direction(random);
        const shared::ParaboloidPoint point = shared::paraboloid_from_direction(d);
        const auto at = [&](float x, float y) {
            return glm::dvec3(
                shared::direction_from_paraboloid(point.side, point.at + kStep * glm::vec2(x, y)));
        };
        const double area =
            glm::length(glm::cross(at(0.5F, 0) - at(-0.5F, 0), at(0, 0.5F) - at(0, -0.5F)));
        EXPECT_NEAR(area / (static_cast<double>(kStep) * static_cast<double>(kStep)) /
                        static_cast<double>(shared::paraboloid_sr_per_area(d)),
                    1.0, 1e-3);
    }
    constexpr int kSide = 2000;
    double sum = 0.0;
    for (int k = 0; k < kSide * kSide; ++k) {
        const glm::vec3 d = shared::direction_from_paraboloid(
            0, (glm::vec2(k % kSide, k / kSide) + 0.5F) / float{kSide});
        sum += d.z >= 0.0F ? static_cast<double>(shared::paraboloid_sr_per_area(d)) : 0.0;
    }
    EXPECT_NEAR(sum / (static_cast<double>(kSide) * kSide), 2.0 * std::acos(-1.0), 1e-3);
}

}  // namespace
}  // namespace nearfield
