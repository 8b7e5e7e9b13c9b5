// SPDX-License-Identifier: Apache-2.0
// A lamp that is turned and moved is found again, and then differs by nothing; differences that
// are there are told.
#include "formats/farfield/align.h"

#include "formats/farfield/compare.h"
#include "formats/model/profile.h"
#include "formats/photometry/of_lightfield.h"
#include "tests/support/lamps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace nearfield {
namespace {

// Beams without any symmetry that change from one image to the next.
LightField smooth_lamp() {
    Slab slab;
    slab.delta_m = 0.4;
    slab.grid = {6, 5};
    slab.pitch_m = {0.03, 0.025};
    slab.texels = {48, 40};
    slab.s_max_m = {0.3, 0.25};
    slab.s_min_m = -slab.s_max_m;
    slab.profile = model::make_profile("bspline");
    for (int m = 0; m < slab.image_count(); ++m)
        for (int j = 0; j < slab.texels.y; ++j)
            for (int i = 0; i < slab.texels.x; ++i) {
                const glm::dvec2 s = slab.s_min_m + (glm::dvec2(i, j) + 0.5) * slab.texel_m();
                const glm::dvec2 wide = (s - glm::dvec2(0.05 + 0.01 * m, -0.02)) / 0.12;
                const glm::dvec2 small = (s - glm::dvec2(-0.1, 0.08)) / 0.05;
                slab.coeffs.push_back(static_cast<float>(std::exp(-glm::dot(wide, wide)) +
                                                         0.7 * std::exp(-glm::dot(small, small))));
            }
    for (const float c : slab.coeffs)
        slab.sigma.push_back(0.1F * c);
    LightField lamp;
    lamp.slabs = {slab};
    return lamp;
}

// The lamp in another frame: p_a = R p_b + t.
LightField seen_from(LightField lamp, const Rigid& a_from_b) {
    const glm::dmat3 b_from_a = glm::transpose(a_from_b.rotation);
    for (Slab& slab : lamp.slabs) {
        slab.luminaire_from_slab.rotation = b_from_a * slab.luminaire_from_slab.rotation;
        slab.luminaire_from_slab.translation_m =
            b_from_a * (slab.luminaire_from_slab.translation_m - a_from_b.translation_m);
    }
    return lamp;
}

double angle_deg(const glm::dmat3& rotation) {
    const double trace = rotation[0][0] + rotation[1][1] + rotation[2][2];
    return std::acos(std::clamp(0.5 * (trace - 1), -1.0, 1.0)) * 180 / std::numbers::pi;
}

farfield::CompareOptions few() {
    farfield::CompareOptions options;
    options.directions = 100;
    return options;
}

TEST(Compare, ALampIsItself) {
    const LightField lamp = smooth_lamp();
    const auto result = compare(farfield::view_of(lamp), farfield::view_of(lamp), {}, few());
    EXPECT_EQ(result.flux_a, result.flux_b);
    EXPECT_EQ(result.intensity.rms_rel, 0);
    ASSERT_EQ(result.near_field.size(), 4U);
    EXPECT_EQ(result.near_field[0].illuminance.rms_rel, 0);
}

TEST(Compare, TellsAFactorInSigmas) {
    const LightField lamp = smooth_lamp();
    LightField brighter = lamp;
    for (float& c : brighter.slabs[0].coeffs)
        c *= 1.1F;
    const auto result = compare(farfield::view_of(lamp), farfield::view_of(brighter), {}, few());
    EXPECT_NEAR(result.flux_b / result.flux_a, 1.1, 1e-6);
    EXPECT_NEAR(result.intensity.mean_rel, 0.1 / 1.05, 1e-6);
    EXPECT_NEAR(result.intensity.p95_rel, 0.1 / 1.05, 1e-6);
    EXPECT_NEAR(result.near_field[2].illuminance.rms_rel, 0.1 / 1.05, 1e-6);
    EXPECT_NEAR(result.intensity.rms_in_sigmas * result.intensity.sigma_rel, 0.1 / 1.05, 0.02);
}

TEST(Align, FindsATurnAndAShift) {
    const LightField lamp = smooth_lamp();
    const Rigid truth{support::rotation_about({0, 0, 1}, 1.2) *
                          support::rotation_about(glm::normalize(glm::dvec3(1, 2, 0)), 0.06),
                      {0.02, -0.015, 0.05}};
    const LightField other = seen_from(lamp, truth);
    const farfield::LampView a = farfield::view_of(lamp), b = farfield::view_of(other);
    EXPECT_GT(compare(a, b, {}, few()).intensity.rms_rel, 0.3);
    const Rigid found = farfield::align(a, b, 0);
    EXPECT_LT(angle_deg(found.rotation * glm::transpose(truth.rotation)), 0.02);
    EXPECT_LT(glm::length(found.translation_m - truth.translation_m), 2e-4);
    const auto result = compare(a, b, found, few());
    EXPECT_LT(result.intensity.rms_rel, 0.002);
    EXPECT_LT(result.near_field[0].illuminance.rms_rel, 0.005);
    const auto unmoved = compare(a, b, {found.rotation, glm::dvec3(0.0)}, few());
    EXPECT_GT(unmoved.near_field[0].illuminance.rms_rel, 0.02);
}

TEST(Align, ATableIsTurnedToItsLightField) {
    const LightField lamp = smooth_lamp();
    const LightField other = seen_from(lamp, {support::rotation_about({0, 0, 1}, -0.7), {}});
    const photometry::Photometry table = photometry::photometry_of(other, {180, 180});
    const farfield::LampView a = farfield::view_of(lamp), b = farfield::view_of(table);
    const Rigid found = farfield::align(a, b, 0);
    EXPECT_LT(angle_deg(found.rotation * support::rotation_about({0, 0, 1}, 0.7)), 0.2);
    const auto result = compare(a, b, found, few());
    EXPECT_TRUE(result.near_field.empty());
    EXPECT_LT(result.intensity.median_rel, 0.01);
}

}  // namespace
}  // namespace nearfield
