// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/visibility_fit.h"

#include "tests/environment/skies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace nearfield::environment {
namespace {

VisibilityFit fit_of(const LatLong& picture, int count) {
    return make_visibility_fit(picture, make_sky_table(picture), count);
}

LatLong even_sky() {
    return test::sky(32, [](glm::dvec3) { return glm::vec3(2.0F); });
}

// Proves that directions as far lamps hold the picture's light: an even sky of 2 gives 2 pi on any
// surface.
TEST(VisibilityFit, DirectionsHoldTheLight) {
    const VisibilityFit fit = fit_of(even_sky(), 4096);
    ASSERT_EQ(fit.directions.size(), 4096U);
    const glm::vec3 normal = glm::normalize(glm::vec3(0.3F, -0.5F, 0.7F));
    float sum = 0.0F;
    for (std::size_t n = 0; n < fit.directions.size(); ++n)
        sum += fit.light[n].x * std::max(glm::dot(normal, fit.directions[n]), 0.0F);
    EXPECT_NEAR(sum / (2.0F * std::acos(-1.0F)), 1.0F, 0.01F);
}

// Proves that a function of l <= 3 comes back, but for what the ridge takes (3 %), and that nothing
// makes nothing.
TEST(VisibilityFit, SmoothFunctionsComeBack) {
    const VisibilityFit fit = fit_of(even_sky(), 1024);
    const auto smooth = [](glm::vec3 d) { return 1.0F + d.x + 2.0F * d.y * d.z + d.x * d.y * d.z; };
    std::vector<float> values;
    for (const glm::vec3 direction : fit.directions)
        values.push_back(smooth(direction));
    const HarmonicValues harmonics = harmonics_of(fit, values);
    for (const glm::vec3 d :
         {glm::vec3(1, 0, 0), glm::vec3(0, 0.6F, 0.8F), glm::normalize(glm::vec3(1, -1, 1))})
        EXPECT_NEAR(value_of(harmonics, d), smooth(d), 0.04F * std::abs(smooth(d)) + 0.02F);
    for (const float value : harmonics_of(fit, std::vector<float>(1024, 0.0F)))
        EXPECT_EQ(value, 0.0F);
}

// Proves that few directions, all at one place, give finite coefficients and the value there.
TEST(VisibilityFit, StaysFiniteWhereDirectionsCoincide) {
    const VisibilityFit fit = fit_of(test::lone_sun(32, {10, 8}, 1e6F), 16);
    const HarmonicValues harmonics =
        harmonics_of(fit, std::vector<float>(fit.directions.size(), 0.7F));
    for (const float value : harmonics)
        EXPECT_TRUE(std::isfinite(value));
    EXPECT_NEAR(value_of(harmonics, fit.directions.front()), 0.7F, 0.05F);
}

}  // namespace
}  // namespace nearfield::environment
