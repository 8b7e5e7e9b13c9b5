// SPDX-License-Identifier: Apache-2.0
#include "sample_data/project.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "sample_data/headlight.h"
#include "sample_data/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace nearfield::sample_data {
namespace {

struct SpanCase {
    std::string basis;
    Weighting weighting;
};

class LampInTheSpan : public ::testing::TestWithParam<SpanCase> {
  protected:
    // Random coefficients in [0.1, 1] and a source whose radiance is exactly that light field's.
    LampInTheSpan() {
        truth_.delta_m = 0.3;
        truth_.grid = {4, 3};
        truth_.pitch_m = {0.02, 0.03};
        truth_.texels = {5, 6};
        truth_.s_min_m = {-0.10, -0.06};
        truth_.s_max_m = {0.12, 0.08};
        truth_.profile = model::make_profile(GetParam().basis);
        truth_.weighting = GetParam().weighting;
        truth_.channels = 3;
        SplitMix random{3};
        truth_.coeffs.resize(std::size_t{3} * 12 * 30);
        for (float& coefficient : truth_.coeffs) {
            coefficient = static_cast<float>(0.1 + 0.9 * random.next());
        }
        source_.aperture.half_m =
            0.5 * truth_.pitch_m *
            glm::dvec2(truth_.grid + static_cast<int>(truth_.profile.cells.size()) - 1);
        source_.radiance_row = [this](glm::dvec2 u_m, double s_y_m, std::span<const double> s_x_m,
                                      std::span<double> rgb) {
            for (std::size_t i = 0; i < s_x_m.size(); ++i) {
                const glm::dvec3 color = model::radiance(truth_, u_m, {s_x_m[i], s_y_m});
                for (std::size_t c = 0; c < 3; ++c) {
                    rgb[c * s_x_m.size() + i] = color[static_cast<int>(c)];
                }
            }
        };
    }

    Slab truth_;
    Source source_;
};

TEST_P(LampInTheSpan, IsRecovered) {
    // Proves data, Gram matrix, solve and rescaling together: any error in one moves the
    // coefficients.
    constexpr double kTolerance =
        1e-6;  // floored by float coefficients, 6e-8, times the Gram's condition
    constexpr double kFluxTolerance = 1e-5;  // radiance weighting: cos^4 is no polynomial
    Slab planes = truth_;
    planes.coeffs.clear();
    const Projection projection = project(source_, planes, {});
    ASSERT_EQ(projection.slab.coeffs.size(), truth_.coeffs.size());
    for (std::size_t k = 0; k < truth_.coeffs.size(); ++k) {
        ASSERT_NEAR(projection.slab.coeffs[k], truth_.coeffs[k], kTolerance) << "coefficient " << k;
    }
    EXPECT_LT(projection.figures.negative_share, kTolerance);
    EXPECT_LT(projection.figures.rescaled_share, kTolerance);
    EXPECT_NEAR(projection.figures.flux_lm, model::luminance(model::flux(truth_)),
                kFluxTolerance * projection.figures.flux_lm);
}

INSTANTIATE_TEST_SUITE_P(Bases,
                         LampInTheSpan,
                         ::testing::Values(SpanCase{"box", Weighting::Irradiance},
                                           SpanCase{"bilinear", Weighting::Irradiance},
                                           SpanCase{"quadratic", Weighting::Irradiance},
                                           SpanCase{"bspline", Weighting::Irradiance},
                                           SpanCase{"bspline", Weighting::Radiance}),
                         [](const auto& test) {
                             return test.param.basis +
                                    (test.param.weighting == Weighting::Irradiance ? "Irradiance"
                                                                                   : "Radiance");
                         });

TEST(Projection, KeepsTheHeadlightsFlux) {
    // Proves that clamping takes no light away, in total and for one channel, near and far S.
    constexpr double kFloat = 1e-6;  // coefficients are floats
    constexpr double kQuadrature =
        2e-3;  // lens nodes against make_headlight's own sum at this size
    const Headlight headlight = make_headlight();
    for (const double delta_m : {0.2, 3.0}) {
        for (const int channels : {1, 3}) {
            const Projection projection =
                project(headlight_source(headlight, delta_m),
                        headlight_planes(delta_m, {5, 4}, {40, 24}, "bspline",
                                         Weighting::Irradiance, channels),
                        {});
            const ProjectFigures& figures = projection.figures;
            EXPECT_NEAR(model::luminance(model::flux(projection.slab)), figures.flux_lm,
                        kFloat * figures.flux_lm);
            EXPECT_NEAR(figures.flux_lm, 1000.0, 1000.0 * kQuadrature);
            EXPECT_GT(figures.negative_share, 0.0);
            for (const float coefficient : projection.slab.coeffs) {
                ASSERT_GE(coefficient, 0.0F);
            }
        }
    }
}

TEST(Projection, StatedQuadratureErrorBoundsAFinerOnesChange) {
    // Proves that `quadrature_error` is what it says, at the coarse size where it is largest.
    const Headlight headlight = make_headlight();
    const Slab planes =
        headlight_planes(3.0, {3, 3}, {24, 16}, "bilinear", Weighting::Irradiance, 1);
    const Projection coarse = project(headlight_source(headlight, 3.0), planes, {});
    const Projection fine = project(headlight_source(headlight, 3.0), planes, {2, {}});
    EXPECT_LT(coarse.figures.quadrature_error, 1e-3);
    EXPECT_LT(fine.figures.quadrature_error, coarse.figures.quadrature_error);
    EXPECT_NEAR(fine.figures.flux_lm, coarse.figures.flux_lm, 1e-3 * fine.figures.flux_lm);
}

TEST(Projection, RefusesUnusablePlanes) {
    const Headlight headlight = make_headlight();
    Slab planes = headlight_planes(3.0, {3, 3}, {8, 8}, "box", Weighting::Irradiance, 1);
    planes.delta_m = 0.0;
    EXPECT_THROW(project(headlight_source(headlight, 3.0), planes, {}), Error);
    planes.delta_m = 3.0;
    EXPECT_THROW(project(headlight_source(headlight, 3.0), planes, {0, {}}), Error);
    planes.channels = 2;
    EXPECT_THROW(project(headlight_source(headlight, 3.0), planes, {}), Error);
    // Sizes that would take days or more memory than a machine has; refused at once.
    for (const auto& [grid, texels] : {std::pair{glm::ivec2(9999), glm::ivec2(9999)},
                                       {glm::ivec2(1, 9999), glm::ivec2(1)},
                                       {glm::ivec2(11, 9), glm::ivec2(9999)}}) {
        planes = headlight_planes(3.0, grid, texels, "box", Weighting::Irradiance, 1);
        EXPECT_THROW(project(headlight_source(headlight, 3.0), planes, {}), Error);
    }
}

}  // namespace
}  // namespace nearfield::sample_data
