// SPDX-License-Identifier: Apache-2.0
#include "render/beam.h"

#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "tests/support/lamps.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace nearfield::render {
namespace {

using support::Random;

Slab lamp() {
    return support::random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 1);
}

glm::dvec3 random_point(Random& random) {
    return {random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), random.uniform(-0.3, 0.6)};
}

// Proves, against the exact sum in double, that no light arrives outside the beam.
TEST(Beam, NoLightArrivesOutsideIt) {
    const Slab slab = lamp();
    const Beam beam = beam_of(slab);
    Random random{7};
    int outside = 0, lit = 0;
    for (int k = 0; k < 4000; ++k) {
        const std::array<glm::dvec3, 1> point = {random_point(random)};
        const double y = model::irradiance(slab, {point[0], {0, 0, -1}}).y;
        lit += y > 0.0 ? 1 : 0;
        if (may_meet(beam, point))
            continue;
        ++outside;
        EXPECT_EQ(y, 0.0) << point[0].x << " " << point[0].y << " " << point[0].z;
    }
    EXPECT_GT(outside, 1000);
    // The beam is not everything: most of what it says may be lit is (the lamp's dark texels and
    // cells apart).
    EXPECT_GT(lit, 3 * (4000 - outside) / 4);
}

// Proves that hulls around a point of a ray from U through S meet the beam, however they lie.
TEST(Beam, HullsAroundPointsOfRaysMeetIt) {
    const Beam beam = beam_of(lamp());
    Random random{3};
    const auto between = [&](glm::dvec2 low, glm::dvec2 high) {
        return glm::mix(low, high, glm::dvec2(random.uniform(), random.uniform()));
    };
    for (int k = 0; k < 5000; ++k) {
        const glm::dvec2 u = between(beam.u_min_m, beam.u_max_m);
        const glm::dvec2 s = between(beam.s_min_m, beam.s_max_m);
        const double z = random.uniform(-0.999, 5.0) * beam.delta_m;
        const glm::dvec3 on_ray(u + (s - u) * (1.0 + z / beam.delta_m), z);
        // A tetrahedron with the point somewhere inside it.
        std::array<glm::dvec3, 4> hull{};
        std::array<double, 4> weights{};
        double sum = 0.0;
        for (double& weight : weights)
            sum += weight = random.uniform(0.01, 1.0);
        glm::dvec3 rest = on_ray;
        for (std::size_t i = 0; i < 3; ++i) {
            hull[i] = on_ray + random_point(random);
            rest -= weights[i] / sum * hull[i];
        }
        hull[3] = rest / (weights[3] / sum);
        EXPECT_TRUE(may_meet(beam, hull));
    }
}

// Proves what is left out: boxes behind U, beside the beam beyond S, and beside the slab.
TEST(Beam, BoxesBehindAndBesideDoNot) {
    const Beam beam{{-0.1, -0.2}, {0.1, 0.2}, {-0.3, -0.4}, {0.3, 0.4}, 0.5};
    const auto meets = [&](glm::dvec3 center) {
        std::vector<glm::dvec3> corners;
        for (unsigned c = 0; c < 8; ++c)
            corners.push_back(center +
                              0.05 * (2.0 * glm::dvec3(c & 1U, (c >> 1U) & 1U, c >> 2U) - 1.0));
        return may_meet(beam, corners);
    };
    EXPECT_FALSE(meets({0, 0, -0.6}));
    EXPECT_TRUE(meets({0, 0, -0.5}));
    // x <= 0.3 + 0.4 z / 0.5 beyond S, y <= 0.4 + 0.6 z / 0.5.
    EXPECT_TRUE(meets({1.1, 0, 1.0}));
    EXPECT_FALSE(meets({1.21, 0, 1.0}));
    EXPECT_FALSE(meets({-1.21, 0, 1.0}));
    EXPECT_TRUE(meets({0, 1.6, 1.0}));
    EXPECT_FALSE(meets({0, -1.75, 1.0}));
    // x <= 0.3 + 0.2 z / 0.5 between.
    EXPECT_TRUE(meets({0.2, 0, -0.25}));
    EXPECT_FALSE(meets({0.28, 0, -0.25}));
}

}  // namespace
}  // namespace nearfield::render
