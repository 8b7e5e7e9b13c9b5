// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/sample_count.glsl.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield {
namespace {

shared::Brdf lobe(shared::uint kind, float exponent, glm::vec2 alpha) {
    shared::Brdf brdf{};
    brdf.kind = kind;
    brdf.specular = glm::vec3(1.0F);
    brdf.exponent = exponent;
    brdf.alpha = alpha;
    brdf.cosines = {-1.0F, -1.0F, 1.0F};
    return brdf;
}

/// 1/(integral of the density squared), by the midpoint rule in double.
double solid_angle_sr(const shared::Brdf& brdf, glm::vec3 to_viewer) {
    constexpr int kRows = 1500, kColumns = 1500;
    const double pi = std::acos(-1.0);
    double sum = 0.0;
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            const double z = (row + 0.5) / kRows, azimuth = 2.0 * pi * (column + 0.5) / kColumns;
            const double across = std::sqrt(1.0 - z * z);
            const glm::vec3 to_light(across * std::cos(azimuth), across * std::sin(azimuth), z);
            sum += std::pow(
                static_cast<double>(shared::brdf_lobe_density(brdf, to_light, to_viewer)), 2);
        }
    return kRows * kColumns / (sum * 2.0 * pi);
}

// Proves that a lobe's solid angle, taken from its peak, is what its definition says: within 3 % of
// Phong's and Ward's, and within 40 % of GGX', whose tails are long, and of the halfway disk's.
TEST(SampleCount, SolidAngleIsTheLobes) {
    const glm::vec3 to_viewer = glm::normalize(glm::vec3(0.5F, 0.2F, 0.9F));
    const auto ratio = [&](const shared::Brdf& brdf) {
        return static_cast<double>(shared::brdf_lobe_solid_angle_sr(brdf, to_viewer)) /
               solid_angle_sr(brdf, to_viewer);
    };
    EXPECT_NEAR(ratio(lobe(shared::kBrdfPhong, 50.0F, {})), 1.0, 0.03);
    EXPECT_NEAR(ratio(lobe(shared::kBrdfLafortune, 100.0F, {})), 1.0, 0.03);
    EXPECT_NEAR(ratio(lobe(shared::kBrdfWard, 0.0F, {0.1F, 0.1F})), 1.0, 0.03);
    EXPECT_NEAR(ratio(lobe(shared::kBrdfWard, 0.0F, {0.05F, 0.2F})), 1.0, 0.1);
    EXPECT_NEAR(ratio(lobe(shared::kBrdfGgx, 0.0F, {0.2F, 0.2F})), 1.0, 0.4);
    EXPECT_NEAR(ratio(lobe(shared::kBrdfHalfwayDisk, 100.0F, {})), 1.0, 0.4);
    // Below the horizon there is none.
    shared::Brdf off = lobe(shared::kBrdfLafortune, 10.0F, {});
    off.cosines = {-1.0F, -1.0F, -0.5F};
    EXPECT_EQ(shared::brdf_lobe_solid_angle_sr(off, to_viewer), 0.0F);
}

// Proves the curvature of a fine triangle of a sphere, 1/radius, and that a flat one has none.
TEST(SampleCount, CurvatureIsTheSpheres) {
    const glm::vec3 a(0.0F, 0.0F, 1.0F), b = glm::normalize(glm::vec3(0.05F, 0.0F, 1.0F)),
                                         c = glm::normalize(glm::vec3(0.02F, 0.04F, 1.0F));
    EXPECT_NEAR(shared::triangle_curvature(3.0F * (b - a), 3.0F * (c - b), a, b, c), 1.0F / 3.0F,
                1e-4F);
    EXPECT_EQ(shared::triangle_curvature(b - a, c - b, a, a, a), 0.0F);
    EXPECT_EQ(shared::triangle_curvature(glm::vec3(0.0F), glm::vec3(0.0F), a, a, a), 0.0F);
}

// Proves what the count follows: none of light that does not vary asks for more than the least;
// deviation over error to the power of 5/4; camera samples that look elsewhere share the work.
TEST(SampleCount, FollowsDeviationErrorAndLooks) {
    EXPECT_EQ(shared::filtered_sample_count(0.0F, 1.0F, 0.01F, 512), 8);
    EXPECT_EQ(shared::filtered_sample_count(0.0F, 1.0F, 0.01F, 4), 4);
    EXPECT_EQ(shared::filtered_sample_count(1.0F, 1.0F, 0.1F, 512), 24);     // 10^1.25 = 17.8
    EXPECT_EQ(shared::filtered_sample_count(100.0F, 1.0F, 0.1F, 512), 320);  // 316.2
    EXPECT_EQ(shared::filtered_sample_count(100.0F, 4.0F, 0.1F, 512), 136);  // over 4^0.625
    EXPECT_EQ(shared::filtered_sample_count(1e30F, 1.0F, 0.1F, 100), 100);
    EXPECT_EQ(shared::relative_variance(0.0F, 1.0F), 0.0F);
    EXPECT_FLOAT_EQ(shared::relative_variance(2.0F, 12.0F), 2.0F);
    EXPECT_FLOAT_EQ(shared::independent_looks(0.0F, 0.1F, 16.0F), 1.0F);
    EXPECT_FLOAT_EQ(shared::independent_looks(1.0F, 0.1F, 16.0F), 16.0F);
    EXPECT_FLOAT_EQ(shared::independent_looks(0.1F, 12.5663706F * 0.04F, 16.0F), 4.0F);
}

}  // namespace
}  // namespace nearfield
