// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/mean_density.glsl.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield {
namespace {

shared::Brdf phong(float exponent) {
    shared::Brdf brdf{};
    brdf.specular = glm::vec3(1.0F);
    brdf.exponent = exponent;
    return brdf;
}

// Proves the cap against closed form: about the axis of a cosine's power it holds
// 1 - (cosine of its radius)^(n + 1) of all.
TEST(MeanDensity, CapHoldsItsShareOfALobe) {
    const glm::vec3 up(0.0F, 0.0F, 1.0F);
    for (const float exponent : {1.0F, 20.0F, 300.0F})
        for (const float count : {4.0F, 32.0F, 256.0F}) {
            const double sr =
                static_cast<double>(shared::mfis_solid_angle_sr(phong(exponent), up, up, count));
            const double cosine = 1.0 - sr / (2.0 * std::acos(-1.0));
            const double held = 1.0 - std::pow(cosine, static_cast<double>(exponent) + 1.0);
            EXPECT_NEAR(held * static_cast<double>(count), 1.0, 0.03) << exponent << " " << count;
        }
}

// Proves what it is for: beside the peak a cap that reaches into it is smaller than 1/(N density)
// says; about the peak it is larger; and a flat density makes no difference.
TEST(MeanDensity, ReachesLessFarIntoThePeak) {
    const glm::vec3 up(0.0F, 0.0F, 1.0F);
    const shared::Brdf narrow = phong(200.0F);
    const auto ratio = [&](const shared::Brdf& brdf, float angle, float count) {
        const glm::vec3 beside(std::sin(angle), 0.0F, std::cos(angle));
        return shared::mfis_solid_angle_sr(brdf, beside, up, count) * count *
               shared::brdf_lobe_density(brdf, beside, up);
    };
    EXPECT_LT(ratio(narrow, 0.3F, 16.0F), 0.2F);
    EXPECT_GT(ratio(narrow, 0.0F, 16.0F), 1.0F);
    EXPECT_NEAR(ratio(phong(0.0F), 0.2F, 64.0F), 1.0F, 0.02F);
}

}  // namespace
}  // namespace nearfield
