// SPDX-License-Identifier: Apache-2.0
// The predicted sigma of intensity is the spread of intensity over lamps whose coefficients err
// as their sigma says.
#include "formats/model/intensity_sigma.h"

#include "formats/model/luminaire.h"
#include "tests/support/lamps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nearfield {
namespace {

class IntensitySigma : public testing::TestWithParam<Weighting> {};

TEST_P(IntensitySigma, IsTheSpreadOverNoisyLamps) {
    LightField lamp;
    lamp.slabs = {support::random_lamp(support::all_profiles()[0], GetParam(), 5)};
    Slab& slab = lamp.slabs[0];
    slab.luminaire_from_slab.rotation = support::rotation_about({1, 0, 0}, 0.3);
    for (const float c : slab.coeffs)
        slab.sigma.push_back(0.3F * c);
    const glm::dvec3 direction =
        slab.luminaire_from_slab.rotation * glm::normalize(glm::dvec3(0.1, -0.2, 1));
    const double predicted = model::intensity_sigma_y(lamp, direction);
    ASSERT_GT(predicted, 0);

    constexpr int kLamps = 400;
    std::mt19937_64 random(1);
    std::normal_distribution<float> normal;
    const double mean = model::luminance(model::intensity(lamp, direction));
    double squares = 0;
    LightField noisy = lamp;
    for (int k = 0; k < kLamps; ++k) {
        for (std::size_t i = 0; i < slab.coeffs.size(); ++i)
            noisy.slabs[0].coeffs[i] = slab.coeffs[i] + slab.sigma[i] * normal(random);
        const double off = model::luminance(model::intensity(noisy, direction)) - mean;
        squares += off * off;
    }
    // The spread of a standard deviation from n draws is 1 / sqrt(2 n) of it; 4 of those.
    EXPECT_NEAR(std::sqrt(squares / kLamps), predicted, 4 / std::sqrt(2.0 * kLamps) * predicted);
    lamp.scale_sigma_rel = 0.5;
    EXPECT_NEAR(model::intensity_sigma_y(lamp, direction), std::hypot(predicted, 0.5 * mean),
                1e-12 * mean);
}

INSTANTIATE_TEST_SUITE_P(OfBothWeightings,
                         IntensitySigma,
                         testing::Values(Weighting::Irradiance, Weighting::Radiance));

}  // namespace
}  // namespace nearfield
