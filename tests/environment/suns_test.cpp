// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/environment.h"
#include "formats/shared/suns.glsl.h"
#include "formats/shared/tonemap.glsl.h"
#include "tests/environment/skies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::environment {
namespace {

/// Irradiance of all light on a surface that faces a direction, whatever is behind it: linear, so
/// that its errors are of light.
glm::dvec3 vector_light(const LatLong& picture, const Suns* suns) {
    glm::dvec3 sum(0.0);
    for (int y = 0; y < picture.size_px.y; ++y)
        for (int x = 0; x < picture.size_px.x; ++x)
            sum += glm::dvec3(pixel_direction(picture, {x, y})) * pixel_sr(picture, y) *
                   static_cast<double>(picture.radiance[picture.index({x, y})].g);
    if (suns != nullptr)
        for (const Sun& sun : suns->suns)
            sum += glm::dvec3(sun.direction) * static_cast<double>(sun.irradiance.g);
    return sum;
}

LatLong two_lamps() {
    return test::sky(64, [](glm::dvec3 d) {
        const auto lamp = [&](glm::dvec3 at) {
            return glm::distance(d, glm::normalize(at)) < 0.08 ? 500.0 : 0.0;
        };
        return glm::vec3(static_cast<float>(0.3 + 0.2 * d.y + lamp({1.0, 0.2, 0.3}) +
                                            2.0 * lamp({-0.4, 1.0, 0.5})));
    });
}

// Proves that no light is lost: suns and the rest together are the picture, in sum and in
// direction, and what is left of a sun's pixels is no brighter than 8 times the mean.
TEST(Suns, AndTheRestAreThePicture) {
    const LatLong picture = two_lamps();
    const Suns suns = take_suns(picture, 64);
    EXPECT_GT(suns.suns.size(), 1U);
    EXPECT_LT(glm::length(vector_light(suns.rest, &suns) - vector_light(picture, nullptr)),
              3e-3 * glm::length(vector_light(picture, nullptr)));
    double of_suns = 0.0;
    for (const Sun& sun : suns.suns)
        of_suns += static_cast<double>(sun.irradiance.g);
    const double whole = 4.0 * std::acos(-1.0);
    EXPECT_NEAR(static_cast<double>(mean_luminance(suns.rest)) * whole + of_suns,
                static_cast<double>(mean_luminance(picture)) * whole, 1e-4 * of_suns);
    for (const glm::vec3 rgb : suns.rest.radiance)
        EXPECT_LE(rgb.g, 8.001F * mean_luminance(picture));
}

// Proves that the brightest come first, that `most` is kept to, and that a dark or even picture has
// none and loses nothing.
TEST(Suns, AreTheBrightestAndFew) {
    const LatLong picture = two_lamps();
    const Suns one = take_suns(picture, 1);
    ASSERT_EQ(one.suns.size(), 1U);
    EXPECT_LT(glm::distance(one.suns[0].direction, glm::normalize(glm::vec3(-0.4F, 1.0F, 0.5F))),
              0.1F);
    EXPECT_LT(one.radius_rad, 0.15F);
    const LatLong even = test::sky(16, [](glm::dvec3) { return glm::vec3(1.0F); });
    EXPECT_TRUE(take_suns(even, 8).suns.empty());
    EXPECT_EQ(take_suns(even, 8).rest.radiance, even.radiance);
    EXPECT_TRUE(take_suns(test::lone_sun(16, {3, 3}, 0.0F), 8).suns.empty());
    Parts parts;
    parts.maps = true;
    parts.suns = 8;
    EXPECT_FALSE(prepare(even, parts).maps_with_suns.has_value());
    EXPECT_TRUE(prepare(picture, parts).maps_with_suns.has_value());
}

// Proves where lobes turn from points to maps.
TEST(Suns, AreShownByNarrowLobes) {
    EXPECT_EQ(shared::suns_in_maps(0.05F, 0.02F), 0.0F);
    EXPECT_EQ(shared::suns_in_maps(0.02F, 0.02F), 1.0F);
    EXPECT_NEAR(shared::suns_in_maps(0.03F, 0.02F), 0.5F, 1e-6F);
}

}  // namespace
}  // namespace nearfield::environment
