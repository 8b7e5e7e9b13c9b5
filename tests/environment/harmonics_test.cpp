// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/harmonics.h"

#include "formats/shared/spherical_harmonics.glsl.h"
#include "tests/environment/skies.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::environment {
namespace {

double harmonic(int k, glm::dvec3 d) {
    return static_cast<double>(shared::harmonic(k, glm::vec3(d)));
}

// Proves that the functions are orthonormal: 16 different ones, each of its constant.
TEST(SphericalHarmonics, AreOrthonormal) {
    for (int a = 0; a < shared::kHarmonics; ++a)
        for (int b = a; b < shared::kHarmonics; ++b)
            EXPECT_NEAR(test::over_sphere(
                            100, [&](glm::dvec3 d) { return harmonic(a, d) * harmonic(b, d); }),
                        a == b ? 1.0 : 0.0, 2e-3)  // the midpoint rule's
                << a << " " << b;
}

// Proves the cosine's factors by definition: what a clamped cosine about an axis makes of each
// function is the factor times the function's value at the axis.
TEST(SphericalHarmonics, CosineFactorsAreIntegrals) {
    const glm::dvec3 axis = glm::normalize(glm::dvec3(0.3, -0.5, 0.7));
    for (int k = 0; k < shared::kHarmonics; ++k)
        EXPECT_NEAR(test::over_sphere(400,
                                      [&](glm::dvec3 d) {
                                          return std::max(glm::dot(d, axis), 0.0) * harmonic(k, d);
                                      }),
                    static_cast<double>(shared::cosine_factor(k)) * harmonic(k, axis), 1e-3)
            << k;
}

// Proves irradiance against the sum over pixels where nothing is lost: radiance of l <= 2.
TEST(Irradiance, IsExactForSmoothLight) {
    const LatLong picture = test::sky(64, [](glm::dvec3 d) {
        return glm::vec3(2.0 + d.x, 1.5 + d.y * d.z, 1.0 + 0.5 * d.z * d.z);
    });
    const Harmonics harmonics = project(picture);
    support::Random random{1};
    for (int k = 0; k < 50; ++k) {
        const glm::dvec3 n = glm::normalize(
            glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        const glm::dvec3 direct = direct_irradiance(picture, n);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(irradiance(harmonics, n)[c] / direct[c], 1.0, 2e-3);  // of 64 rows
    }
    EXPECT_NEAR(
        irradiance(project(test::sky(64, [](glm::dvec3) { return glm::vec3(1.0F); })), {0, 1, 0}).x,
        std::acos(-1.0), 1e-3);
}

// Proves what the header says of a single sun, the worst light there is: 1/16 too much where a
// surface faces it, off by 3/32 at most (at the horizon; from the series 1/4 + c/2 + (15 c^2 -
// 5)/32 of a clamped cosine c), and never negative.
TEST(Irradiance, OfASunIsOffByThreeThirtySecondsAtMost) {
    const LatLong picture = test::lone_sun(128, {80, 40}, 1e4F);
    const Harmonics harmonics = project(picture);
    const glm::dvec3 sun(pixel_direction(picture, {80, 40}));
    const double most = direct_irradiance(picture, sun).x;
    double worst = 0.0;
    support::Random random{2};
    for (int k = 0; k < 500; ++k) {
        const glm::dvec3 n =
            k == 0 ? sun
                   : glm::normalize(glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1),
                                               random.uniform(-1, 1)));
        const double e = static_cast<double>(irradiance(harmonics, n).x);
        EXPECT_GE(e, 0.0);
        worst = std::max(worst, std::abs(e - direct_irradiance(picture, n).x) / most);
    }
    EXPECT_LE(worst, 3.0 / 32.0 + 1e-3);
    EXPECT_GE(worst, 3.0 / 32.0 - 1e-3);
    EXPECT_NEAR(static_cast<double>(irradiance(harmonics, sun).x) / most, 17.0 / 16.0, 1e-3);
}

}  // namespace
}  // namespace nearfield::environment
