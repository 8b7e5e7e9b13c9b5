// SPDX-License-Identifier: Apache-2.0
// Sums over a fit's images against the model's own over the whole light field.
#include "app/fit_light.h"

#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "tests/support/lamps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::app {
namespace {

Slab lamp(int replicates) {
    Slab slab = support::random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 3);
    slab.sigma = slab.coeffs;
    for (float& sigma : slab.sigma)
        sigma *= 0.1F;
    for (int r = 0; r < replicates; ++r) {
        slab.replicates.push_back(slab.coeffs);
        for (float& coefficient : slab.replicates.back())
            coefficient *= 1.0F + 0.01F * static_cast<float>(r + 1);
    }
    return slab;
}

TEST(FitLight, IsThatOfTheWhole) {
    const Slab slab = lamp(0);
    LightField whole;
    whole.slabs = {slab};
    const FitLight light = light_of(slab);
    EXPECT_NEAR(light.flux_lm / model::luminance(model::flux(whole)), 1.0, 1e-12);
    EXPECT_NEAR(light.flux_sigma_lm / model::flux_sigma_y(whole), 1.0, 1e-12);
    ASSERT_EQ(light.views.size(), 4U);
    for (const LensView& view : light.views) {
        const glm::ivec2 px = view.size_px / 3;
        const glm::dvec2 u_m = view.lower_m + (glm::dvec2(px) + 0.5) *
                                                  (view.upper_m - view.lower_m) /
                                                  glm::dvec2(view.size_px);
        const double expected =
            model::luminance(model::radiance(slab, u_m, u_m + slab.delta_m * view.tangent));
        EXPECT_NEAR(view.cd_per_m2[static_cast<std::size_t>(px.y * view.size_px.x + px.x)],
                    expected, 1e-9 * expected);
    }
}

// Behind a basis whose functions add up to one, light on S is their mean over U: by a sum over U.
TEST(FitLight, OnSIsTheIntegralOverU) {
    const Slab slab = lamp(0);
    const FitLight light = light_of(slab);
    constexpr int kSteps = 600;
    const glm::dvec2 half_m = 0.5 * (glm::dvec2(slab.grid) + 4.0) * slab.pitch_m;
    const glm::dvec2 step_m = 2.0 * half_m / double{kSteps};
    const int i = slab.texels.x / 2, j = slab.texels.y / 3;
    const glm::dvec2 s_m = slab.s_min_m + (glm::dvec2(i, j) + 0.5) * slab.texel_m();
    double sum_lx = 0;
    for (int row = 0; row < kSteps; ++row)
        for (int column = 0; column < kSteps; ++column) {
            const glm::dvec2 u_m =
                slab.u_center_m - half_m + (glm::dvec2(column, row) + 0.5) * step_m;
            const glm::dvec2 aside = (s_m - u_m) / slab.delta_m;
            const double cos4 = std::pow(1.0 + glm::dot(aside, aside), -2.0);
            sum_lx += model::luminance(model::radiance(slab, u_m, s_m)) * cos4 * step_m.x *
                      step_m.y / (slab.delta_m * slab.delta_m);
        }
    EXPECT_NEAR(light.on_s_lx[static_cast<std::size_t>(j * slab.texels.x + i)] / sum_lx, 1.0, 1e-4);
}

TEST(FitLight, SigmaOfTheFluxIsTheReplicatesSpread) {
    const FitLight light = light_of(lamp(2));
    EXPECT_NEAR(light.flux_sigma_lm / light.flux_lm, std::sqrt((0.01 * 0.01 + 0.02 * 0.02) / 2),
                1e-6);
}

}  // namespace
}  // namespace nearfield::app
