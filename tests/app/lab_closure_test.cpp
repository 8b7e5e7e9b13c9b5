// SPDX-License-Identifier: Apache-2.0
// The comparison with a bench's truth, by measurements whose errors are known.
#include "app/lab_closure.h"

#include "fit/solve_capture.h"
#include "formats/files/error.h"
#include "formats/model/profile.h"

#include <gtest/gtest.h>

namespace nearfield::app {
namespace {

constexpr double kDelta_m = 0.2;
constexpr double kScaleSigma = 0.01;

LabTruth coarse_truth() {
    LabTruth truth;
    sample_data::Bench& bench = truth.bench;
    bench.delta_m = kDelta_m;
    bench.filter.profile = model::make_profile("bspline");
    bench.filter.grid = {11, 9};
    bench.filter.pitch_m = {0.02, 0.0216667};
    bench.accuracy.lens_step = 2.5;  // both sides of the comparison see the same light
    truth.places = sample_data::make_places(bench);
    truth.headlight = sample_data::make_headlight();
    truth.lamp_factor = 1.02;
    return truth;
}

Slab coarse_planes(const LabTruth& truth) {
    Slab planes = sample_data::headlight_planes(kDelta_m, {9, 7}, {20, 12}, "bspline",
                                                Weighting::Irradiance, 1);
    planes.grid = truth.bench.filter.grid;
    planes.pitch_m = truth.bench.filter.pitch_m;
    return planes;
}

// The truth as if measured, times `scale`, with optics that are off by `shift_m` along y.
fit::RectifiedCapture measured(const LabTruth& truth, double scale, double shift_m) {
    const Slab planes = coarse_planes(truth);
    const TrueTexels texels = true_texels(truth, planes);
    fit::RectifiedCapture capture{
        planes,
        true_optics(truth),
        fit::MeasuredTexels(".", planes.texels, static_cast<int>(texels.positions), {}, 1.0, {1.0}),
        {},
        kScaleSigma,
        {}};
    for (glm::dvec3& position_m : capture.optics.position_m)
        position_m.y += shift_m;
    for (std::size_t k = 0; k < texels.positions; ++k) {
        fit::RectifiedImage image;
        for (std::size_t t = 0; t < planes.texel_count(); ++t) {
            image.value.push_back(
                static_cast<float>(scale * double(texels.lux[k * planes.texel_count() + t])));
            image.variance.push_back(1e-6F);
        }
        capture.texels.put(static_cast<int>(k), {image});
    }
    return capture;
}

Closure closed(double scale, double shift_m) {
    const LabTruth truth = coarse_truth();
    const fit::RectifiedCapture capture = measured(truth, scale, shift_m);
    fit::CaptureFitOptions options;
    options.lambda = 1e-3;
    const fit::CaptureFit fit = fit::solve_capture(capture, capture.optics, options);
    return closure_of(truth, 1.001 * kDelta_m, capture, options, fit);
}

// Proves that a measurement without errors closes: nothing but the basis is between it and truth.
TEST(LabClosure, APerfectMeasurementCloses) {
    const Closure closure = closed(1.0, 0.0);
    EXPECT_GT(closure.receivers.size(), 100U);
    EXPECT_LT(closure.irradiance_rms, 1e-4);  // texels are floats
    EXPECT_EQ(closure.coverage_3sigma, 1.0);
    EXPECT_NEAR(closure.flux_rel, closure.noise_free_flux_rel, 1e-5);
    EXPECT_LT(std::abs(closure.flux_rel), 0.02);  // texels of 20 mm, nodes far apart
    EXPECT_NEAR(closure.delta_rel, 1e-3, 1e-9);
    EXPECT_NEAR(closure.irradiance_rms_truth, closure.basis_rms_truth, 1e-4);
    EXPECT_EQ(closure.lamp_factor, 1.02);
}

// Proves that an error of scale is seen as what it is, and is no error of places.
TEST(LabClosure, AScaleErrorIsTheLights) {
    const Closure closure = closed(1.3, 0.0);
    EXPECT_NEAR(closure.irradiance_rms, 0.3, 1e-3);
    EXPECT_NEAR(closure.flux_rel - closure.noise_free_flux_rel, 0.3, 0.01);
    EXPECT_EQ(closure.coverage_3sigma, 0.0);  // thirty sigmas of scale; noise adds to them
    ASSERT_EQ(closure.budget.size(), 3U);
    EXPECT_NEAR(closure.budget[0].irradiance_bias, 0.3, 1e-3);
    EXPECT_LT(closure.budget[1].irradiance_rms, 1e-6);
    EXPECT_NEAR(closure.budget[2].flux_rel, 0.3, 1e-3);
}

// Proves that an error of places is told from one of light.
TEST(LabClosure, AShiftedFilterIsThePlaces) {
    const Closure closure = closed(1.0, 5e-4);
    ASSERT_EQ(closure.budget.size(), 3U);
    EXPECT_GT(closure.budget[0].irradiance_rms, 2e-3);
    EXPECT_NEAR(closure.budget[1].irradiance_rms / closure.budget[0].irradiance_rms, 1.0, 0.01);
    EXPECT_LT(closure.budget[2].irradiance_rms, 1e-4);
}

TEST(LabClosure, ALampWithoutFormulaIsRefused) {
    sample_data::Bench bench = coarse_truth().bench;
    bench.lamp.file = "lamp.lightfield.exr";
    EXPECT_THROW(lab_truth(bench, rig::Rig{}, 0), Error);
}

}  // namespace
}  // namespace nearfield::app
