// SPDX-License-Identifier: Apache-2.0
// The filter's profile and centers, against the virtual bench and against brute force.
#include "calibrate/radiometry.h"
#include "formats/files/error.h"
#include "formats/model/profile.h"
#include "sample_data/bench/prepared.h"
#include "tests/calibrate/lab_frames.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::test {
namespace {

using capture::ShotKind;

glm::dvec2 seen_px(const sample_data::Bench& bench, glm::ivec2 position) {
    const sample_data::Places places = sample_data::make_places(bench);
    const auto k = static_cast<std::size_t>(position.y * bench.filter.grid.x + position.x);
    const glm::dvec3 in_bench =
        apply(places.bench_from_filter, glm::dvec3(places.position_m[k], 0.0));
    return *sample_data::project_px(bench.camera,
                                    apply(inverse(bench.camera.bench_from_camera), in_bench));
}

/// A camera that sees the filter 20 pixels a pitch, in the middle of its picture.
sample_data::Bench filter_bench(const std::string& basis) {
    sample_data::Bench bench = sensor_bench();
    bench.filter.profile = model::make_profile(basis);
    bench.filter.step_sigma_m = 5e-5;
    bench.camera.size_px = {120, 112};
    bench.camera.fx_px = 620;
    bench.camera.fy_px = 622;
    bench.camera.cx_px = 170;
    bench.camera.cy_px = 56;
    bench.accuracy.subsamples = 4;
    bench.accuracy.screen_step_px = 8;  // the screen is not looked at
    bench.accuracy.lens_step = 8;
    const glm::dvec2 middle = seen_px(bench, {1, 1});
    bench.camera.cx_px += 60.0 - middle.x;
    bench.camera.cy_px += 56.0 - middle.y;
    return bench;
}

LabFrames views_of(const sample_data::Bench& bench) {
    LabFrames lab(bench);
    for (const double exposure_us : {4000.0, 17000.0, 200000.0})
        lab.add(ShotKind::Dark, exposure_us, 6);
    for (const double exposure_us : {4000.0, 9000.0, 17000.0})
        lab.add(ShotKind::Flat, exposure_us, 6);
    for (const glm::ivec2 position : {glm::ivec2(0, 0), glm::ivec2(1, 1), glm::ivec2(2, 1)})
        lab.add(ShotKind::Filter, 17000.0, 2, position);
    return lab;
}

calibrate::FilterGeometry geometry_of(const LabFrames& lab) {
    const sample_data::PreparedBench& truth = *lab.prepared;
    const sample_data::BenchCamera& camera = truth.bench.camera;
    calibrate::FilterGeometry geometry;
    geometry.lens = {rig::LensModel::Brown5,
                     camera.size_px,
                     camera.fx_px,
                     camera.fy_px,
                     camera.cx_px,
                     camera.cy_px,
                     {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3}};
    const Rigid u_frame = inverse(camera.bench_from_camera) * truth.places.bench_from_filter;
    geometry.camera_from_u = u_frame;
    geometry.pitch_m = truth.bench.filter.pitch_m;
    geometry.psf_sigma_px = camera.psf_sigma_px;
    return geometry;
}

struct Measured {
    calibrate::RadiometryResult result;
    std::vector<calibrate::FilterView> views;
};

Measured measure(const LabFrames& lab) {
    Measured measured;
    const capture::Capture capture = lab.capture();
    measured.result = calibrate::calibrate_sensor(capture, lab.reader(), {}, {});
    const calibrate::SortedFrames frames = calibrate::sorted_frames(capture);
    measured.views = calibrate::measure_filter(frames.filters, geometry_of(lab),
                                               lab.prepared->bench.filter.profile, lab.reader(),
                                               measured.result);
    return measured;
}

class Filter : public testing::TestWithParam<const char*> {};

TEST_P(Filter, CentersProfileAndPeakAreFound) {
    const LabFrames lab = views_of(filter_bench(GetParam()));
    const Measured measured = measure(lab);
    const sample_data::PreparedBench& truth = *lab.prepared;
    ASSERT_EQ(measured.views.size(), 3U);
    for (const calibrate::FilterView& view : measured.views) {
        const glm::dvec2 off = view.center_px - seen_px(truth.bench, view.position);
        const glm::dvec2 sigma(std::sqrt(view.covariance_px2[0][0]),
                               std::sqrt(view.covariance_px2[1][1]));
        EXPECT_LT(glm::length(off), 0.02);
        // Beside sigma what the bench's four samples a pixel blur differently.
        EXPECT_LT(std::abs(off.x), 3.5 * sigma.x + 0.004) << off.x;
        EXPECT_LT(std::abs(off.y), 3.5 * sigma.y + 0.004) << off.y;
        EXPECT_LT(sigma.x, 0.01);
    }
    const calibrate::FilterProfileResult& filter = *measured.result.filter;
    EXPECT_NEAR(filter.turn_rad, 0.0, 3.5 * filter.turn_sigma_rad + 1e-5);
    const Profile& nominal = truth.bench.filter.profile;
    const double at_center = model::eval(nominal, 0.0);
    const double half = 0.5 * static_cast<double>(nominal.cells.size());
    double squares = 0;
    for (double x = -half + 0.025; x < half; x += 0.05)
        squares +=
            std::pow(model::eval(filter.profile, x) - model::eval(nominal, x) / at_center, 2.0) *
            0.05 / (2.0 * half);
    EXPECT_LT(std::sqrt(squares), 0.003);
    // What the camera's own color sees of the filter, against white.
    const double peak = (150 * 0.9 + 250 * 0.8 + 90 * 0.7) / 490 * at_center * at_center;
    EXPECT_NEAR(filter.peak[0], peak, 3.5 * filter.peak_sigma[0] + 0.001);
    EXPECT_NEAR(model::eval(filter.profile, 0.0), 1.0, 0.002);
    EXPECT_LT(filter.chi2 / double(filter.pixels - std::size_t(filter.parameters)), 1.3);
    EXPECT_LT(filter.asymmetry, 0.005);
    EXPECT_EQ(filter.jumps, std::string(GetParam()) == "box" ? 2 : 0);
    RecordProperty("profile_rms", std::to_string(std::sqrt(squares)));
}

INSTANTIATE_TEST_SUITE_P(Bases, Filter, testing::Values("bspline", "box", "bilinear"));

TEST(FilterProfile, AFilterOfAnotherWidthIsToldFromTheNominalOne) {
    sample_data::Bench bench = filter_bench("bspline");
    LabFrames lab = views_of(bench);
    const capture::Capture capture = lab.capture();
    calibrate::RadiometryResult result = calibrate::calibrate_sensor(capture, lab.reader(), {}, {});
    calibrate::FilterGeometry geometry = geometry_of(lab);
    geometry.pitch_m *= 1.05;  // believed
    calibrate::measure_filter(calibrate::sorted_frames(capture).filters, geometry,
                              bench.filter.profile, lab.reader(), result);
    EXPECT_GT(result.filter->nominal_deviation, 0.02);
    EXPECT_GT(result.filter->nominal_sigmas, 10.0);
}

TEST(FilterProfile, AViewWithoutFilterIsRefused) {
    const LabFrames lab = views_of(filter_bench("box"));
    calibrate::FilterPicture empty;
    constexpr std::size_t kPixels = 13'440;  // 120 x 112
    empty.transmission.assign(kPixels, 0.0F);
    empty.sigma.assign(kPixels, 0.01F);
    EXPECT_THROW(
        calibrate::filter_profile_of({&empty, 1}, geometry_of(lab), model::make_profile("box"), 1,
                                     std::vector<int>(kPixels)),
        Error);
}

TEST(FilterProfile, MomentsOfTruncatedGaussiansAreTheirIntegrals) {
    for (const double x : {-1.3, 0.2, 0.5}) {
        for (const double s : {0.02, 0.4}) {
            const glm::dvec3 moments = calibrate::blurred_moments(x, s, -0.5, 0.5);
            glm::dvec3 sum(0.0);
            constexpr int kSteps = 200000;
            for (int k = 0; k < kSteps; ++k) {
                const double t = -0.5 + (k + 0.5) / kSteps;
                const double density = std::exp(-0.5 * (t - x) * (t - x) / (s * s)) /
                                       (s * std::sqrt(6.283185307179586));
                sum += density / kSteps * glm::dvec3(1.0, t, t * t);
            }
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(moments[k], sum[k], 1e-9);
        }
    }
}

}  // namespace
}  // namespace nearfield::test
