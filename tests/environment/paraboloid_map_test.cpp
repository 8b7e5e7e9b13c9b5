// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/paraboloid_map.h"

#include "formats/files/error.h"
#include "formats/shared/environment_maps.glsl.h"
#include "formats/shared/tonemap.glsl.h"
#include "tests/environment/skies.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::environment {
namespace {

/// Light of both maps' own half spaces at a level, by the sum over points of the sphere.
double light_of(const ParaboloidMap& map, float level, int n) {
    return test::over_sphere(
        n, [&](glm::dvec3 d) { return static_cast<double>(filtered(map, glm::vec3(d), level).y); });
}

double light_of(const LatLong& picture) {
    double sum = 0.0;
    for (int y = 0; y < picture.size_px.y; ++y)
        for (int x = 0; x < picture.size_px.x; ++x)
            sum += pixel_sr(picture, y) *
                   static_cast<double>(picture.radiance[picture.index({x, y})].y);
    return sum;
}

// Proves that a constant stays constant, to rounding, at every level and between them.
TEST(ParaboloidMap, KeepsAConstant) {
    const ParaboloidMap map =
        make_paraboloid_map(test::sky(8, [](glm::dvec3) { return glm::vec3(0.25F, 1.0F, 3.0F); }));
    for (const float level : {-1.0F, 0.0F, 0.3F, 2.0F, 2.7F, 9.0F})
        EXPECT_LT(glm::distance(filtered(map, glm::normalize(glm::vec3(1, -2, 0.1F)), level),
                                {0.25F, 1.0F, 3.0F}),
                  1e-6F);
}

// Proves that each level is half the one before, down to one texel, and what sides are allowed.
TEST(ParaboloidMap, HalvesDownToOneTexel) {
    const LatLong picture = test::sunny_sky(32);
    EXPECT_EQ(side_for(picture), 64);
    const ParaboloidMap map = make_paraboloid_map(picture);
    ASSERT_EQ(map.levels.size(), 7U);
    EXPECT_EQ(map.side_px(), 64);
    EXPECT_EQ(map.levels.back().side_px, 1);
    EXPECT_THROW(make_paraboloid_map(picture, 48), Error);
}

// Proves that the finest level holds the picture's light, a sun of one pixel wherever it stands
// included: neither lost between texels nor doubled at the seam.
TEST(ParaboloidMap, HoldsTheLightOfSmallSuns) {
    double sum = 0.0, worst = 0.0;
    int count = 0;
    for (const glm::ivec2 pixel : {glm::ivec2(5, 3),
                                   {16, 8},
                                   {0, 15},
                                   {47, 16},
                                   {33, 20},
                                   {8, 16},
                                   {24, 16},
                                   {60, 29},
                                   {48, 12},
                                   {15, 15}}) {
        const LatLong picture = test::lone_sun(32, pixel, 1e6F);
        const double error =
            light_of(make_paraboloid_map(picture), 0.0F, 1000) / light_of(picture) - 1.0;
        sum += error;
        worst = std::max(worst, std::abs(error));
        ++count;
    }
    EXPECT_LT(worst, 0.01);
    EXPECT_LT(std::abs(sum / count), 0.003);
    const LatLong picture = test::sunny_sky(32);
    EXPECT_NEAR(light_of(make_paraboloid_map(picture), 0.0F, 1000) / light_of(picture), 1.0, 0.01);
}

// Proves that levels are means: one texel of the next is that of four, and the top is the mean of
// all, of luminance squared too.
TEST(ParaboloidMap, LevelsAreMeans) {
    const ParaboloidMap map = make_paraboloid_map(test::sunny_sky(16));
    for (int side = 0; side < 2; ++side) {
        glm::dvec3 sum(0.0);
        double square = 0.0;
        for (const glm::vec4& texel : map.levels.front().sides[static_cast<std::size_t>(side)]) {
            sum += glm::dvec3(glm::vec3(texel)) / map.texels();
            square += std::pow(static_cast<double>(shared::luminance709(glm::vec3(texel))), 2) /
                      map.texels();
        }
        const glm::vec4 top = map.levels.back().sides[static_cast<std::size_t>(side)].front();
        EXPECT_NEAR(top.y / sum.y, 1.0, 1e-5);
        EXPECT_NEAR(top.w / square, 1.0, 1e-5);
    }
}

// Proves that what a direction shows on the finest level is the picture, where that is smooth.
TEST(ParaboloidMap, ShowsThePicture) {
    const auto smooth = [](glm::dvec3 d) { return glm::vec3(2.0 + d.x, 2.0 + d.y, 2.0 + d.z); };
    const ParaboloidMap map = make_paraboloid_map(test::sky(64, smooth));
    support::Random random{4};
    for (int k = 0; k < 1000; ++k) {
        const glm::dvec3 d = glm::normalize(
            glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        EXPECT_LT(glm::distance(filtered(map, glm::vec3(d), 0.0F), smooth(d)), 0.05F);
    }
}

}  // namespace
}  // namespace nearfield::environment
