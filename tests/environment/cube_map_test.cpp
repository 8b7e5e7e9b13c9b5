// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/cube_map.h"

#include "formats/environment/paraboloid_map.h"
#include "formats/files/error.h"
#include "tests/environment/skies.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::environment {
namespace {

LatLong smooth_sky() {
    return test::sky(64, [](glm::dvec3 d) { return glm::vec3(2.0 + d.x, 2.0 + d.y, 2.0 + d.z); });
}

// Proves that each face shows its part of the picture, and that levels keep its light.
TEST(CubeMap, ShowsThePicture) {
    const CubeMap map = make_cube_map(smooth_sky(), 64);
    support::Random random{4};
    for (int k = 0; k < 1000; ++k) {
        const glm::dvec3 d = glm::normalize(
            glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        EXPECT_LT(glm::distance(filtered(map, glm::vec3(d), 0.0F), glm::vec3(2.0 + d)), 0.05F);
    }
    EXPECT_THROW(make_cube_map(smooth_sky(), 48), Error);
    const CubeMap even =
        make_cube_map(test::sky(8, [](glm::dvec3) { return glm::vec3(3.0F); }), 16);
    ASSERT_EQ(even.levels.size(), 5U);
    for (const float level : {-1.0F, 0.5F, 3.7F, 9.0F})
        EXPECT_LT(glm::distance(filtered(even, {0, -1, 0}, level), glm::vec3(3.0F)), 1e-6F);
}

// Proves the measure of a face: it integrates to the sphere.
TEST(CubeMap, FacesCoverTheSphere) {
    const double area =
        test::over_sphere(400, [](glm::dvec3 d) { return 1.0 / cube_sr_per_area(glm::vec3(d)); });
    EXPECT_NEAR(area, 6.0, 1e-3);
}

// Proves what the cube map is kept for: where its faces meet coarse levels jump; paraboloids, which
// know what lies beyond their seam, jump less.
TEST(CubeMap, JumpsWhereFacesMeet) {
    const LatLong picture = smooth_sky();
    const CubeMap cube = make_cube_map(picture, 64);
    const ParaboloidMap paraboloids = make_paraboloid_map(picture, 128);
    double of_cube = 0.0, of_paraboloids = 0.0;
    for (int k = 0; k < 200; ++k) {
        const double t = (k + 0.5) / 100.0 - 1.0, azimuth = std::acos(-1.0) * t;
        const auto at = [&](double side) { return glm::normalize(glm::vec3(1.0 + side, 1.0, t)); };
        const auto on_seam = [&](double side) {
            return glm::normalize(glm::vec3(std::cos(azimuth), std::sin(azimuth), side));
        };
        of_cube =
            std::max(of_cube, static_cast<double>(glm::distance(filtered(cube, at(1e-5), 4.0F),
                                                                filtered(cube, at(-1e-5), 4.0F))));
        of_paraboloids = std::max(
            of_paraboloids,
            static_cast<double>(glm::distance(filtered(paraboloids, on_seam(1e-5), 5.0F),
                                              filtered(paraboloids, on_seam(-1e-5), 5.0F))));
    }
    EXPECT_GT(of_cube, 0.1);
    EXPECT_LT(of_paraboloids, 0.5 * of_cube);
}

}  // namespace
}  // namespace nearfield::environment
