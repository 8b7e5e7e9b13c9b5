// SPDX-License-Identifier: Apache-2.0
// What a sensor does by itself, against the virtual bench, whose numbers calibrate never sees.
#include "calibrate/flat_field.h"
#include "calibrate/noise.h"
#include "formats/files/error.h"
#include "formats/rig/curve.h"
#include "sample_data/bench/prepared.h"
#include "tests/calibrate/lab_frames.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::test {
namespace {

using capture::ShotKind;

constexpr double kHotSigmas = 8.0;

/// Darks and flats of one camera, taken once for all tests.
const LabFrames& sensor_lab() {
    static const LabFrames lab = [] {
        LabFrames made(sensor_bench());
        for (const double exposure_us : {2000.0, 50000.0, 400000.0, 2e6})
            made.add(ShotKind::Dark, exposure_us, 6);
        for (const double exposure_us : {1000.0, 4000.0, 9000.0, 17000.0})
            made.add(ShotKind::Flat, exposure_us, 8);
        return made;
    }();
    return lab;
}

calibrate::DarkResult dark_of_lab(const LabFrames& lab) {
    return calibrate::dark_of(lab.groups(ShotKind::Dark), lab.layout(), lab.reader(), kHotSigmas);
}

calibrate::NoiseResult noise_of_lab(const LabFrames& lab, const calibrate::DarkResult& dark) {
    calibrate::TransferSums sums(lab.layout(), dark.black_dn, dark.is_hot);
    for (const ShotKind kind : {ShotKind::Dark, ShotKind::Flat}) {
        for (const calibrate::ExposureGroup& group : lab.groups(kind)) {
            for (std::size_t k = 0; k + 1 < group.frames.size(); k += 2)
                sums.add(lab.reader()(*group.frames[k]), lab.reader()(*group.frames[k + 1]));
        }
    }
    return calibrate::noise_of(sums.points(), lab.layout().range_dn());
}

rig::Radiometry radiometry_of_lab(const LabFrames& lab, const calibrate::DarkResult& dark) {
    const calibrate::NoiseResult noise = noise_of_lab(lab, dark);
    rig::Radiometry radiometry;
    radiometry.bits = 12;
    radiometry.gain_e_per_dn = noise.gain_e_per_dn;
    radiometry.read_noise_dn = noise.read_noise_dn;
    radiometry.saturation_dn = 3800;
    return radiometry;
}

// Reduced chi-square of pixels against their truth and their own sigma.
struct Pulls {
    double squares = 0, sum = 0, count = 0;
    void add(double error, double sigma) {
        squares += error * error / (sigma * sigma);
        sum += error / sigma;
        count += 1.0;
    }
};

TEST(Dark, PixelsBlackLevelsAndRatesAreFoundWithinTheirSigma) {
    const LabFrames& lab = sensor_lab();
    const sample_data::PreparedBench& truth = *lab.prepared;
    const calibrate::DarkResult dark = dark_of_lab(lab);
    Pulls black, rate;
    for (std::size_t k = 0; k < dark.black_dn.size(); ++k) {
        if (dark.is_hot[k] != 0.0F)
            continue;
        const auto& camera = truth.bench.camera;
        black.add(dark.black_dn[k] - camera.black_level_dn - truth.offset_dn[k],
                  dark.black_sigma_dn);
        rate.add(dark.dark_dn_per_s[k] - truth.dark_e_per_s[k] / camera.gain_e_per_dn,
                 dark.rate_sigma_dn_per_s);
    }
    // Chi-square of 9200 pixels: 1 +- 0.015; weights are by exposure, not by pixel, whose dark
    // current differs by a fifth.
    EXPECT_NEAR(black.squares / black.count, 1.0, 0.08);
    EXPECT_NEAR(rate.squares / rate.count, 1.0, 0.08);
    EXPECT_LT(std::abs(black.sum / std::sqrt(black.count)), 3.0);
    EXPECT_LT(std::abs(rate.sum / std::sqrt(rate.count)), 3.0);
}

TEST(Dark, HotPixelsAreFoundAndNoOthers) {
    const LabFrames& lab = sensor_lab();
    const calibrate::DarkResult dark = dark_of_lab(lab);
    int hot = 0;
    for (std::size_t k = 0; k < dark.is_hot.size(); ++k) {
        const bool is_hot = lab.prepared->dark_e_per_s[k] > 10.0 * 40.0;
        hot += is_hot ? 1 : 0;
        EXPECT_EQ(dark.is_hot[k] != 0.0F, is_hot) << "pixel " << k;
    }
    EXPECT_GE(hot, 3);
    EXPECT_EQ(dark.hot_pixels, hot);
}

TEST(Dark, OneExposureGivesNoRateAndNoDarksAreRefused) {
    const LabFrames& lab = sensor_lab();
    std::vector<calibrate::ExposureGroup> groups = lab.groups(ShotKind::Dark);
    groups.resize(1);
    const calibrate::DarkResult dark =
        calibrate::dark_of(groups, lab.layout(), lab.reader(), kHotSigmas);
    EXPECT_EQ(dark.dark_dn_per_s[5], 0.0F);
    EXPECT_NEAR(dark.points[0].mean_dn, 48.0, 0.1);
    EXPECT_THROW(calibrate::dark_of({}, lab.layout(), lab.reader(), kHotSigmas), Error);
}

// Noise-free frames of 4 x 2 pixels with their own black levels, dark currents and light of the
// room, at temperatures before and after: each is found, and growth is the formula's.
struct WarmDarks {
    std::vector<capture::FrameRecord> records;
    std::vector<calibrate::ExposureGroup> groups;

    explicit WarmDarks(double warmer_c) {
        for (const double exposure_us : {1e5, 4e5, 2e6})
            for (const double temperature_c : {20.0, 20.0 + warmer_c}) {
                capture::FrameRecord record;
                record.shot.exposure_us = exposure_us;
                record.temperature_c = temperature_c;
                record.size_px = {4, 2};
                records.push_back(record);
            }
        for (std::size_t k = 0; k < records.size(); k += 2)
            groups.push_back({records[k].shot.exposure_us, {&records[k], &records[k + 1]}});
    }

    static double black_dn(std::size_t k) { return 100.0 + static_cast<double>(k); }
    static double current_dn_per_s(std::size_t k) { return 800.0 + 40.0 * static_cast<double>(k); }
    static double room_dn_per_s(std::size_t k) { return 300.0 * static_cast<double>(k % 3); }

    static capture::Frame frame(const capture::FrameRecord& record) {
        capture::Frame frame;
        frame.size_px = record.size_px;
        for (std::size_t k = 0; k < 8; ++k)
            frame.values.push_back(static_cast<std::uint16_t>(std::lround(
                black_dn(k) +
                1e-6 * record.shot.exposure_us *
                    (room_dn_per_s(k) +
                     current_dn_per_s(k) * std::pow(2.0, (*record.temperature_c - 20.0) / 7.0)))));
        return frame;
    }

    calibrate::DarkResult dark() const {
        return calibrate::dark_of(groups, calibrate::PixelLayout{{4, 2}, 1, 16, "mono"}, frame, 8);
    }
};

TEST(Dark, LightOfTheRoomIsToldFromDarkCurrentByTwoTemperatures) {
    const WarmDarks warm(6.0);
    const calibrate::DarkResult dark = warm.dark();
    ASSERT_TRUE(dark.is_room_known);
    EXPECT_EQ(dark.temperature_c, 20.0);
    for (std::size_t k = 0; k < 8; ++k) {
        // Values are rounded to a DN of 2000.
        EXPECT_NEAR(dark.black_dn[k], WarmDarks::black_dn(k), 1.0);
        EXPECT_NEAR(dark.room_dn_per_s[k], WarmDarks::room_dn_per_s(k), 3.0);
        EXPECT_NEAR(dark.dark_dn_per_s[k] - dark.room_dn_per_s[k], WarmDarks::current_dn_per_s(k),
                    3.0);
    }
}

TEST(Dark, OneTemperatureDoesNotTellTheRoom) {
    const calibrate::DarkResult dark = WarmDarks(1.0).dark();
    EXPECT_FALSE(dark.is_room_known);
    EXPECT_EQ(dark.room_dn_per_s[2], 0.0F);
    EXPECT_EQ(dark.temperature_c, 20.5);
}

TEST(PhotonTransfer, GainAndReadNoiseAreFoundWithin3SigmaAnd2Percent) {
    const LabFrames& lab = sensor_lab();
    const calibrate::NoiseResult noise = noise_of_lab(lab, dark_of_lab(lab));
    EXPECT_NEAR(noise.gain_e_per_dn, 2.7, 3.0 * noise.gain_sigma);
    EXPECT_NEAR(noise.gain_e_per_dn, 2.7, 0.02 * 2.7);
    const double read_dn = std::sqrt(5.5 * 5.5 / (2.7 * 2.7) + 1.0 / 12.0);
    EXPECT_NEAR(noise.read_noise_dn, read_dn, 3.0 * noise.read_noise_sigma);
    EXPECT_NEAR(noise.read_noise_dn, read_dn, 0.02 * read_dn);
    EXPECT_LT(noise.gain_sigma, 0.01 * 2.7);
    EXPECT_LT(noise.chi2, noise.freedom + 4.0 * std::sqrt(2.0 * noise.freedom));
}

TEST(PhotonTransfer, FullWellBelowTheRangesEndIsRecognizedAndLeftOut) {
    LabFrames lab(sensor_bench());
    for (const double exposure_us : {2000.0, 50000.0})
        lab.add(ShotKind::Dark, exposure_us, 6);
    for (const double exposure_us : {4000.0, 12000.0, 30000.0})
        lab.add(ShotKind::Flat, exposure_us, 6);
    const calibrate::DarkResult dark = dark_of_lab(lab);
    const calibrate::NoiseResult noise = noise_of_lab(lab, dark);
    EXPECT_NEAR(noise.gain_e_per_dn, 2.7, 3.0 * noise.gain_sigma);
    calibrate::LevelHistogram histogram;
    for (const calibrate::ExposureGroup& group : lab.groups(ShotKind::Flat))
        histogram.add(lab.reader()(*group.frames[0]));
    const calibrate::Saturation saturation = calibrate::saturation_of(
        histogram, lab.layout(), 48.0, noise.gain_e_per_dn, noise.read_noise_dn);
    EXPECT_TRUE(saturation.is_full_well);
    const double full_dn = 48.0 + 10500.0 / 2.7;
    EXPECT_NEAR(saturation.clip_dn, full_dn, 2.0);
    // Three sigma of counts below.
    EXPECT_NEAR(saturation.saturation_dn, full_dn - 3.0 * std::sqrt(10500.0) / 2.7, 3.0);
}

TEST(PhotonTransfer, ARangeThatEndsFirstIsSaturationAndDarkFlatsAreRefused) {
    calibrate::LevelHistogram histogram;
    capture::Frame frame;
    frame.bits = 12;
    frame.values.assign(1000, 4095);
    histogram.add(frame);
    calibrate::PixelLayout layout;
    layout.bits = 12;
    const calibrate::Saturation saturation =
        calibrate::saturation_of(histogram, layout, 48.0, 2.7, 2.0);
    EXPECT_TRUE(saturation.is_reached);
    EXPECT_FALSE(saturation.is_full_well);
    EXPECT_EQ(saturation.clip_dn, 4095.0);
    EXPECT_THROW(calibrate::noise_of({{0.0, 4.0, 0.1, 1000, false}}, 4000.0), Error);
}

TEST(FlatField, ResponseIsFoundWithinItsSigma) {
    const LabFrames& lab = sensor_lab();
    const calibrate::DarkResult dark = dark_of_lab(lab);
    const calibrate::FlatResult flat =
        calibrate::flat_field_of(lab.groups(ShotKind::Flat), lab.layout(), dark,
                                 radiometry_of_lab(lab, dark), lab.reader(), 0.2);
    const sample_data::PreparedBench& truth = *lab.prepared;
    double mean = 0, count = 0;
    for (std::size_t k = 0; k < flat.response.size(); ++k) {
        if (dark.is_hot[k] != 0.0F)
            continue;
        mean += truth.flat[k] * truth.prnu[k];
        count += 1.0;
    }
    mean /= count;
    Pulls pulls;
    double squares = 0, sigmas = 0;
    for (std::size_t k = 0; k < flat.response.size(); ++k) {
        if (dark.is_hot[k] != 0.0F)
            continue;
        const double expected = truth.flat[k] * truth.prnu[k] / mean;
        const double error = flat.response[k] / expected - 1.0;
        pulls.add(error, flat.response_sigma_rel[k]);
        squares += error * error;
        sigmas += flat.response_sigma_rel[k];
    }
    EXPECT_NEAR(pulls.squares / pulls.count, 1.0, 0.06);  // 1 +- 0.015, sigma's own model
    EXPECT_LT(std::sqrt(squares / count), 0.005);         // 60,000 electrons each
    EXPECT_NEAR(std::sqrt(squares / count), sigmas / count, 0.1 * sigmas / count);
    EXPECT_NEAR(flat.rate_dn_per_s[0], mean / 2.7, 0.001 * mean / 2.7);
    EXPECT_EQ(flat.dead_pixels, 0);
    EXPECT_LT(flat.linearity_rel, 0.002);  // the bench's camera is linear
    EXPECT_TRUE(flat.linear.x.empty());
}

TEST(FlatField, DeadPixelsAreFoundAndSaturatedFlatsRefused) {
    const LabFrames& lab = sensor_lab();
    const calibrate::DarkResult dark = dark_of_lab(lab);
    rig::Radiometry radiometry = radiometry_of_lab(lab, dark);
    const calibrate::FrameReader with_dead = [&](const capture::FrameRecord& record) {
        capture::Frame frame = lab.reader()(record);
        frame.values[96 * 40 + 30] = 60;
        return frame;
    };
    const calibrate::FlatResult flat = calibrate::flat_field_of(
        lab.groups(ShotKind::Flat), lab.layout(), dark, radiometry, with_dead, 0.2);
    EXPECT_EQ(flat.dead_pixels, 1);
    EXPECT_EQ(flat.is_dead[96 * 40 + 30], 1.0F);
    radiometry.saturation_dn = 100;
    EXPECT_THROW(calibrate::flat_field_of(lab.groups(ShotKind::Flat), lab.layout(), dark,
                                          radiometry, lab.reader(), 0.2),
                 Error);
}

TEST(Linearity, ABentResponseIsStraightenedByItsCurve) {
    const LabFrames& lab = sensor_lab();
    const calibrate::DarkResult dark = dark_of_lab(lab);
    // A camera that loses 4 % of its signal at full scale.
    const auto bent_dn = [](double signal) { return signal * (1.0 - 0.04 * signal / 4000.0); };
    const calibrate::FrameReader bent = [&](const capture::FrameRecord& record) {
        capture::Frame frame = lab.reader()(record);
        for (std::uint16_t& value : frame.values)
            value = static_cast<std::uint16_t>(
                std::max(0.0, std::round(48.0 + bent_dn(double(value) - 48.0))));
        return frame;
    };
    const calibrate::FlatResult flat = calibrate::flat_field_of(
        lab.groups(ShotKind::Flat), lab.layout(), dark, radiometry_of_lab(lab, dark), bent, 0.2);
    EXPECT_GT(flat.linearity_rel, 0.01);
    ASSERT_FALSE(flat.linear.x.empty());
    rig::Radiometry radiometry;
    radiometry.linear = flat.linear;
    const auto straight = [&](double signal) {
        return (rig::linear_dn(radiometry, 48.0 + bent_dn(signal)) - 48.0) / signal;
    };
    // A straight line up to a factor, from a tenth of the range to its last flat.
    for (const double signal : {500.0, 1000.0, 1600.0, 2400.0, 3000.0})
        EXPECT_NEAR(straight(signal) / straight(700.0), 1.0, 0.004) << signal;
}

}  // namespace
}  // namespace nearfield::test
