// SPDX-License-Identifier: Apache-2.0
// The steps together, on a color camera; and what is refused.
#include "calibrate/radiometry.h"

#include "formats/files/error.h"
#include "sample_data/bench/prepared.h"
#include "tests/calibrate/lab_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::test {
namespace {

using capture::ShotKind;

sample_data::Bench color_bench() {
    sample_data::Bench bench = sensor_bench();
    bench.camera.mosaic = sample_data::Mosaic::Rggb;
    bench.camera.response_e_per_cd_m2_s = {150, 20, 5, 30, 250, 40, 5, 25, 180};
    bench.stray.veil_lx = 0.5;
    bench.stray.blocked_share = 0.002;
    bench.photometer.position_m = {0.0, 0.0, 0.0};
    bench.photometer.sigma_lx = 0.01;
    bench.filter.grid = {3, 3};
    return bench;
}

LabFrames color_lab(const sample_data::Bench& bench) {
    LabFrames lab(bench);
    for (const double exposure_us : {1000.0, 4000.0, 17000.0, 500000.0})
        lab.add(ShotKind::Dark, exposure_us, 4);
    for (const double exposure_us : {4000.0, 9000.0, 17000.0})
        lab.add(ShotKind::Flat, exposure_us, 4);
    for (int k = 0; k < 9; ++k) {
        for (const double exposure_us : {1000.0, 4000.0, 17000.0})
            lab.add(ShotKind::Light, exposure_us, 1, {k % 3, k / 3});
    }
    return lab;
}

bool has_flag(const calibrate::RadiometryResult& result, const std::string& part) {
    return std::any_of(result.flags.begin(), result.flags.end(), [&](const calibrate::Flag& flag) {
        return flag.what.find(part) != std::string::npos;
    });
}

TEST(Radiometry, AColorCameraIsCalibratedFromItsCapture) {
    const LabFrames lab = color_lab(color_bench());
    const capture::Capture capture = lab.capture();
    calibrate::RadiometryResult result = calibrate::calibrate_sensor(capture, lab.reader(), {}, {});
    EXPECT_EQ(result.radiometry.mosaic, "rggb");
    EXPECT_NEAR(result.radiometry.gain_e_per_dn, 2.7, 3.0 * result.radiometry.gain_sigma);
    // Every color's response is about 1, whatever its share of white.
    std::vector<double> sum(3), count(3);
    for (std::size_t k = 0; k < result.maps.response.size(); ++k) {
        if (result.maps.is_bad[k] != 0.0F)
            continue;
        const auto color = static_cast<std::size_t>(result.layout.color(k));
        sum[color] += result.maps.response[k];
        count[color] += 1.0;
    }
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(sum[c] / count[c], 1.0, 1e-3);
    // Rates of white: 1000 cd/m^2 in R, G, B, by the bench's matrix; vignetting takes up to 10 %.
    const glm::dvec3 white = glm::dvec3(150 + 30 + 5, 20 + 250 + 25, 5 + 40 + 180) * 1000.0 / 2.7;
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_LT(result.flat->rate_dn_per_s[c], white[int(c)]);
        EXPECT_GT(result.flat->rate_dn_per_s[c], 0.85 * white[int(c)]);
    }
    EXPECT_NEAR(result.flat->rate_dn_per_s[0] / result.flat->rate_dn_per_s[1], 185.0 / 295.0,
                0.002 * 185.0 / 295.0);
    ASSERT_EQ(result.ratios.ratios.size(), 2U);
    EXPECT_NEAR(result.ratios.ratios[0].ratio, 4.0, 3.0 * 4.0 * result.ratios.ratios[0].sigma_rel);
    EXPECT_TRUE(has_flag(result, "veil"));  // no boards here
    calibrate::measure_scale(capture, std::nullopt, {}, lab.reader(), {}, result);
    EXPECT_FALSE(result.radiometry.is_absolute);
    EXPECT_TRUE(has_flag(result, "light is relative"));
    // The photometer with the lamp off sees the room alone.
    EXPECT_NEAR(result.stray.room_lx, 0.5, 4.0 * result.stray.room_sigma_lx + 0.002);
    EXPECT_LT(result.stray.room_sigma_lx, 0.005);
}

TEST(Radiometry, LightBesideTheFilterIsBoundedFromAbove) {
    sample_data::Bench bench = color_bench();
    bench.camera.mosaic = sample_data::Mosaic::Mono;
    const LabFrames lab = color_lab(bench);
    const capture::Capture capture = lab.capture();
    calibrate::RadiometryResult result = calibrate::calibrate_sensor(capture, lab.reader(), {}, {});
    calibrate::FilterProfileResult filter;
    filter.profile = bench.filter.profile;
    for (auto& cell : filter.profile.cells) {
        for (double& coefficient : cell)
            coefficient /= 0.75;  // peak 1
    }
    filter.peak = {0.5625 * 0.8};
    result.filter = filter;
    calibrate::measure_scale(capture, std::nullopt, {}, lab.reader(), {}, result);
    ASSERT_TRUE(result.stray.has_beside_bound);
    EXPECT_GT(result.stray.beside_bound, 0.5 * bench.stray.blocked_share);
    EXPECT_LT(result.stray.beside_bound, 10.0 * bench.stray.blocked_share);
}

TEST(Radiometry, MissingDarksAreRefusedOrAssumedAndFlagged) {
    LabFrames lab(color_bench());
    for (const double exposure_us : {2000.0, 4000.0, 9000.0})
        lab.add(ShotKind::Flat, exposure_us, 4);
    const capture::Capture capture = lab.capture();
    EXPECT_THROW(calibrate::calibrate_sensor(capture, lab.reader(), {}, {}), Error);
    calibrate::RadiometryOptions options;
    options.assumed_black_dn = 48;
    const calibrate::RadiometryResult result =
        calibrate::calibrate_sensor(capture, lab.reader(), options, {});
    EXPECT_TRUE(has_flag(result, "black level of 48 DN is assumed"));
    EXPECT_EQ(result.maps.black_dn[17], 48.0F);
}

TEST(Radiometry, WhatCannotBeCalibratedIsRefusedByName) {
    LabFrames lab(color_bench());
    lab.add(ShotKind::Dark, 4000.0, 4);
    const auto message_of = [&](const capture::Capture& capture) {
        try {
            calibrate::calibrate_sensor(capture, lab.reader(), {}, {});
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("nothing");
    };
    EXPECT_NE(message_of(lab.capture()).find("flats"), std::string::npos);
    EXPECT_NE(message_of({}).find("frames"), std::string::npos);
    capture::Capture mixed = lab.capture();
    mixed.frames.at(2).size_px = {95, 96};
    EXPECT_NE(message_of(mixed).find("different kinds"), std::string::npos);
    capture::Capture photographs = lab.capture();
    photographs.header.response = capture::Response::Unknown;
    EXPECT_NE(message_of(photographs).find("three exposures"), std::string::npos);
    lab.add(ShotKind::Light, 4e6, 1, {1, 2});
    capture::Capture saturated = lab.capture();
    for (auto& [number, record] : saturated.frames)
        record.share_saturated = record.shot.kind == ShotKind::Light ? 0.95 : 0.0;
    EXPECT_NE(message_of(saturated).find("saturated"), std::string::npos);
    capture::Capture unknown = lab.capture();
    unknown.frames.at(0).pixel_format = "BayerXY12";
    EXPECT_NE(message_of(unknown).find("BayerXY12"), std::string::npos);
}

}  // namespace
}  // namespace nearfield::test
