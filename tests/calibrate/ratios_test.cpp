// SPDX-License-Identifier: Apache-2.0
// True exposures and the absolute scale, against a virtual bench that lies about its times.
#include "calibrate/exposure_ratios.h"
#include "calibrate/scale.h"
#include "sample_data/bench/prepared.h"
#include "tests/calibrate/lab_frames.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::test {
namespace {

using capture::ShotKind;

constexpr double kShort_us = 4000, kMiddle_us = 16000, kLong_us = 64000;

LabFrames lights_of(const sample_data::Bench& bench) {
    LabFrames lab(bench);
    lab.real_us = {{kShort_us, 4100.0}, {kLong_us, 63500.0}};
    for (const double exposure_us : {kShort_us, kMiddle_us, kLong_us, 1e6})
        lab.add(ShotKind::Dark, exposure_us, 6);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            for (const double exposure_us : {kShort_us, kMiddle_us, kLong_us})
                lab.add(ShotKind::Light, exposure_us, 1, {column, row});
        }
    }
    return lab;
}

/// What earlier steps would have found, taken from the truth: this tests one step alone.
struct Known {
    calibrate::DarkResult dark;
    rig::Radiometry radiometry;
    rig::Maps maps;
};

Known known_of(const LabFrames& lab) {
    Known known;
    known.dark = calibrate::dark_of(lab.groups(ShotKind::Dark), lab.layout(), lab.reader(), 8.0);
    const sample_data::PreparedBench& truth = *lab.prepared;
    known.radiometry.gain_e_per_dn = truth.bench.camera.gain_e_per_dn;
    known.radiometry.read_noise_dn = std::sqrt(5.5 * 5.5 / (2.7 * 2.7) + 1.0 / 12.0);
    known.radiometry.saturation_dn = 3800;
    known.radiometry.dark_temperature_c = known.dark.temperature_c;
    known.maps.size_px = truth.bench.camera.size_px;
    known.maps.black_dn = known.dark.black_dn;
    known.maps.dark_dn_per_s = known.dark.dark_dn_per_s;
    known.maps.room_dn_per_s = known.dark.room_dn_per_s;
    known.maps.is_bad = known.dark.is_hot;
    double mean = 0;
    for (std::size_t k = 0; k < truth.flat.size(); ++k)
        mean += truth.flat[k] * truth.prnu[k] / static_cast<double>(truth.flat.size());
    for (std::size_t k = 0; k < truth.flat.size(); ++k)
        known.maps.response.push_back(truth.flat[k] * truth.prnu[k] / static_cast<float>(mean));
    return known;
}

calibrate::RatioResult ratios_of_lab(const LabFrames& lab, const Known& known) {
    return calibrate::exposure_ratios_of(lab.brackets(), lab.layout(), known.dark, known.radiometry,
                                         known.maps, lab.reader(), 0.02);
}

TEST(ExposureRatios, TrueTimesAreFoundWithin3SigmaOfAThousandth) {
    const LabFrames lab = lights_of(sensor_bench());
    const calibrate::RatioResult result = ratios_of_lab(lab, known_of(lab));
    ASSERT_EQ(result.ratios.size(), 2U);
    const std::vector<double> real = {kMiddle_us / 4100.0, 63500.0 / kMiddle_us};
    for (std::size_t k = 0; k < 2; ++k) {
        const calibrate::ExposureRatio& one = result.ratios[k];
        EXPECT_LT(std::abs(one.ratio / real[k] - 1.0), 3.0 * one.sigma_rel) << k;
        EXPECT_LT(one.sigma_rel, 1e-3);
        EXPECT_LT(std::abs(one.chi2 - (one.positions - 1)), 4.0 * std::sqrt(2.0 * one.positions));
        EXPECT_EQ(one.positions, 9);
    }
    ASSERT_EQ(result.exposures.size(), 3U);
    EXPECT_EQ(result.reference_us, kMiddle_us);
    EXPECT_NEAR(result.exposures[0].true_us, 4100.0, 3.0 * 4100.0 * result.exposures[0].sigma_rel);
    EXPECT_NEAR(result.exposures[2].true_us, 63500.0,
                3.0 * 63500.0 * result.exposures[2].sigma_rel);
}

TEST(ExposureRatios, SigmaIsWhatRepeatedCapturesScatterBy) {
    std::vector<double> pulls;
    for (int seed = 1; seed <= 12; ++seed) {
        sample_data::Bench bench = sensor_bench();
        bench.camera.size_px = {48, 48};
        bench.camera.fx_px = bench.camera.fy_px = 95;
        bench.camera.cx_px = bench.camera.cy_px = 24;
        bench.seed = static_cast<std::uint64_t>(seed);
        const LabFrames lab = lights_of(bench);
        for (const calibrate::ExposureRatio& one : ratios_of_lab(lab, known_of(lab)).ratios) {
            const double real =
                one.shorter_us == kShort_us ? kMiddle_us / 4100.0 : 63500.0 / kMiddle_us;
            pulls.push_back((one.ratio / real - 1.0) / one.sigma_rel);
        }
    }
    double squares = 0, sum = 0;
    for (const double pull : pulls) {
        squares += pull * pull;
        sum += pull;
    }
    const auto n = static_cast<double>(pulls.size());
    // Chi-square of 24: 1 +- 0.29; a bias would show in the mean.
    EXPECT_GT(squares / n, 0.4);
    EXPECT_LT(squares / n, 1.9);
    EXPECT_LT(std::abs(sum / std::sqrt(n)), 3.0);
}

TEST(ExposureRatios, ALampThatWalksShowsAsDriftAndWidensSigma) {
    sample_data::Bench bench = sensor_bench();
    bench.lamp.walk_sigma_rel = 0.02;
    bench.lamp.walk_s = 0.2;  // frames are 0.1 s apart
    const LabFrames lab = lights_of(bench);
    const calibrate::RatioResult result = ratios_of_lab(lab, known_of(lab));
    EXPECT_GT(result.ratios[0].drift_rel, 0.003);
    EXPECT_LT(std::abs(result.ratios[0].ratio * 4100.0 / kMiddle_us - 1.0),
              3.0 * result.ratios[0].sigma_rel);
    EXPECT_GT(result.ratios[0].sigma_rel, result.ratios[0].drift_rel / 3.5);
}

// A sensor 7 C warmer than its darks has twice their dark current, and the room's light as it was.
TEST(Scale, LightIsWithoutTheDarkCurrentOfItsOwnTemperature) {
    const calibrate::PixelLayout layout{{4, 2}, 1, 16, "mono"};
    rig::Radiometry radiometry;
    radiometry.saturation_dn = 4000;
    radiometry.dark_temperature_c = 20;
    rig::Maps maps;
    maps.size_px = layout.size_px;
    maps.black_dn.assign(8, 100.0F);
    maps.dark_dn_per_s.assign(8, 50.0F);
    maps.room_dn_per_s.assign(8, 20.0F);
    maps.response.assign(8, 2.0F);
    maps.is_bad.assign(8, 0.0F);
    capture::Frame frame;
    frame.size_px = layout.size_px;
    frame.values.assign(8, 100 + 80 + 500);
    capture::FrameRecord record;
    record.shot.exposure_us = 1e6;
    record.temperature_c = 27.0;
    EXPECT_NEAR(calibrate::light_of(frame, record, layout, radiometry, maps)[5], 250.0F, 1e-4);
    record.temperature_c.reset();
    EXPECT_NEAR(calibrate::light_of(frame, record, layout, radiometry, maps)[5], 265.0F, 1e-4);
}

TEST(ExposureRatios, ExposuresWithoutCommonPixelsKeepWhatWasAsked) {
    const LabFrames lab = lights_of(sensor_bench());
    Known known = known_of(lab);
    known.radiometry.saturation_dn = 60;
    const calibrate::RatioResult result = ratios_of_lab(lab, known);
    EXPECT_TRUE(result.ratios.empty());
    EXPECT_EQ(result.exposures[0].true_us, kShort_us);
    EXPECT_EQ(result.exposures[0].sigma_rel, 0.02);
}

TEST(Scale, LuxForLightIsFoundWithin3Sigma) {
    sample_data::Bench bench = sensor_bench();
    bench.lamp.walk_sigma_rel = 0.05;  // cancels
    bench.lamp.walk_s = 1.0;
    bench.screen.tilt_deg = {0.0, 0.0};
    bench.screen.lobe_share = 0.0;
    bench.screen.reflectance = {0.8, 0.8, 0.8};
    // A camera that sees luminance.
    bench.camera.response_e_per_cd_m2_s = {10.63, 0, 0, 35.76, 0, 0, 3.61, 0, 0};
    bench.accuracy.lens_step = bench.accuracy.screen_step_px = 1.0;
    // Pixels of a millimeter, so that the beam is even over the disk that is averaged.
    bench.camera.fx_px = bench.camera.fy_px = 800;
    bench.camera.cx_px = 22;
    bench.camera.cy_px = 80;
    bench.photometer.position_m = {0.02, 0.01, 0.0};
    bench.photometer.sigma_rel = 0.003;
    bench.photometer.sigma_lx = 0.02;
    bench.stray.veil_lx = 2.0;
    LabFrames lab = lights_of(bench);
    Known known = known_of(lab);
    known.radiometry.exposures = {
        {kShort_us, 4100.0, 0.0}, {kMiddle_us, kMiddle_us, 0.0}, {kLong_us, 63500.0, 0.0}};
    // Where the photometer's point is seen, by hand: camera at (0.2, -0.02, 0.7), turned half
    // about x, then by asin(0.28) about y; Brown's distortion.
    const glm::dvec3 from_camera = glm::dvec3(0.02, 0.01, 0.0) - glm::dvec3(0.2, -0.02, 0.7);
    const glm::dvec3 seen = glm::transpose(bench.camera.bench_from_camera.rotation) * from_camera;
    const glm::dvec2 x = glm::dvec2(seen) / seen.z;
    const double r2 = glm::dot(x, x);
    const double radial = 1.0 + r2 * (-0.1 + 0.05 * r2);
    const glm::dvec2 bent(x.x * radial + 2 * 0.002 * x.x * x.y - 0.001 * (r2 + 2 * x.x * x.x),
                          x.y * radial + 0.002 * (r2 + 2 * x.y * x.y) - 2 * 0.001 * x.x * x.y);
    calibrate::PhotometerPlace place;
    place.at_px = bent * 800.0 + glm::dvec2(22, 80);
    place.radius_px = 2;
    const std::vector<calibrate::ScalePoint> points =
        calibrate::scale_points_of(lab.brackets(), lab.groups(ShotKind::Dark), lab.layout(),
                                   known.dark, known.radiometry, known.maps, place, lab.reader());
    const auto scale = calibrate::fit_scale(points, 0.003);
    ASSERT_TRUE(scale);
    // Light in DN/s of a screen under one lux: rho / pi cd/m^2 times the flats' rate of 1 cd/m^2.
    double flat_e = 0;
    for (std::size_t k = 0; k < lab.prepared->flat.size(); ++k)
        flat_e += lab.prepared->flat[k] * lab.prepared->prnu[k] /
                  static_cast<double>(lab.prepared->flat.size());
    const double per_lx = 0.8 / 3.14159265358979 * flat_e / bench.flat_cd_m2 / 2.7;
    // Beside sigma the bench's own stated error of light on the screen.
    EXPECT_NEAR(scale->scale_lx_s_per_dn * per_lx, 1.0,
                3.0 * scale->sigma_rel + lab.prepared->error.total_rel);
    EXPECT_LT(scale->sigma_rel, 0.003);
    EXPECT_NEAR(scale->offset_lx, 2.0, 3.0 * scale->offset_sigma_lx);
    EXPECT_LT(scale->chi2, scale->freedom + 5.0 * std::sqrt(2.0 * scale->freedom));
}

TEST(Scale, TheLineIsRecoveredFromReadingsWithKnownNoise) {
    // 200 captures of a line 0.5 lx s/DN, offset 0.3 lx, with this test's own normal numbers.
    std::uint64_t state = 1;
    const auto uniform = [&state] {
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        return (static_cast<double>(state >> 11U) + 0.5) * 0x1p-53;
    };
    const auto normal = [&uniform] {
        return std::sqrt(-2.0 * std::log(uniform())) * std::cos(6.283185307 * uniform());
    };
    double squares = 0, offsets = 0;
    constexpr int kRuns = 200;
    for (int run = 0; run < kRuns; ++run) {
        std::vector<calibrate::ScalePoint> points;
        for (int k = 0; k < 8; ++k) {
            calibrate::ScalePoint dark;
            dark.reading_lx = 0.3 + 0.02 * normal();
            points.push_back(dark);
        }
        for (int k = 1; k <= 30; ++k) {
            calibrate::ScalePoint lit;
            lit.exposure_us = 1000;
            const double light = 20.0 * k, lx = 0.5 * light + 0.3;
            lit.sigma = 0.5;
            lit.light_dn_per_s = light + 0.5 * normal();
            lit.reading_lx = lx * (1.0 + 0.003 * normal()) + 0.02 * normal();
            points.push_back(lit);
        }
        const auto scale = calibrate::fit_scale(points, 0.003);
        ASSERT_TRUE(scale);
        squares += std::pow((scale->scale_lx_s_per_dn / 0.5 - 1.0) / scale->sigma_rel, 2.0) / kRuns;
        offsets += std::pow((scale->offset_lx - 0.3) / scale->offset_sigma_lx, 2.0) / kRuns;
    }
    EXPECT_NEAR(squares, 1.0, 0.35);  // chi-square of 200: +- 0.1; sigma is never scaled down
    EXPECT_NEAR(offsets, 1.0, 0.35);
    EXPECT_FALSE(calibrate::fit_scale({}, 0.003));
}

}  // namespace
}  // namespace nearfield::test
