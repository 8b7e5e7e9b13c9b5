// SPDX-License-Identifier: Apache-2.0
#include "formats/rig/veil.h"

#include "calibrate/veil_fit.h"
#include "formats/files/error.h"
#include "sample_data/bench/prepared.h"
#include "tests/calibrate/lab_frames.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::test {
namespace {

using capture::ShotKind;

/// G * I by its definition: a sum over all pixels.
double direct_blur(const std::vector<float>& picture, glm::ivec2 size, double sigma, int x, int y) {
    double sum = 0;
    for (int j = 0; j < size.y; ++j) {
        for (int i = 0; i < size.x; ++i) {
            const double r2 = double(i - x) * (i - x) + double(j - y) * (j - y);
            sum += picture[static_cast<std::size_t>(j * size.x + i)] *
                   std::exp(-0.5 * r2 / (sigma * sigma));
        }
    }
    return sum / (2.0 * 3.14159265358979 * sigma * sigma);
}

TEST(Veil, TheWideBlurIsTheGaussianOfItsDefinition) {
    const glm::ivec2 size(120, 90);
    std::vector<float> picture(std::size_t{120} * 90);
    for (int y = 20; y < 45; ++y) {
        for (int x = 30; x < 95; ++x)
            picture[static_cast<std::size_t>(y * 120 + x)] = 1.0F + 0.02F * float(x);
    }
    for (const double sigma : {3.0, 10.0, 23.0}) {
        const std::vector<float> blurred = rig::wide_blur(picture, size, sigma);
        for (int y = 2; y < 90; y += 17) {
            for (int x = 2; x < 120; x += 19)
                EXPECT_NEAR(blurred[static_cast<std::size_t>(y * 120 + x)],
                            direct_blur(picture, size, sigma, x, y), 0.02)  // of 2: blocks
                    << sigma << " at " << x << ", " << y;
        }
    }
}

TEST(Veil, WhatWasAddedIsRemoved) {
    const glm::ivec2 size(64, 48);
    constexpr double kShare = 0.06, kSigma = 9.0;
    for (const char* const mosaic : {"mono", "rggb", "rgb"}) {
        const rig::Interleave interleave = rig::interleave_of(mosaic);
        std::vector<float> picture(static_cast<std::size_t>(64 * 48 * interleave.channels));
        for (std::size_t k = 0; k < picture.size(); ++k)
            picture[k] = k % 64 > 40 ? 1000.0F + float(k % 7) : 0.0F;
        std::vector<float> veiled = picture;
        for (int p = 0; p < interleave.planes(); ++p) {
            std::vector<float> plane = interleave.plane_of(picture, size, p);
            const std::vector<float> wide =
                rig::wide_blur(plane, interleave.size_px(size, p), kSigma / interleave.step.x);
            for (std::size_t k = 0; k < plane.size(); ++k)
                plane[k] += float(kShare) * (wide[k] - plane[k]);
            interleave.put(plane, p, size, veiled);
        }
        const std::vector<float> clear = rig::remove_veil(veiled, size, mosaic, kShare, kSigma);
        double worst = 0;
        for (std::size_t k = 0; k < picture.size(); ++k)
            worst = std::max(worst, std::abs(double(clear[k]) - picture[k]));
        EXPECT_LT(worst, 0.01) << mosaic;  // of 1000: float
    }
    EXPECT_THROW(rig::remove_veil({}, size, "mono", 0.1, 5.0), Error);
    EXPECT_THROW(rig::remove_veil(std::vector<float>(std::size_t{64} * 48), size, "mono", 0.7, 5.0),
                 Error);
}

sample_data::Bench veil_bench(double share) {
    sample_data::Bench bench = sensor_bench();
    bench.camera.size_px = {160, 128};
    bench.camera.fx_px = 230;
    bench.camera.fy_px = 230;
    bench.camera.cx_px = 80;
    bench.camera.cy_px = 64;
    bench.camera.veil_share = share;
    bench.camera.veil_sigma_px = 24;
    bench.camera.hot_share = 0;
    bench.accuracy.subsamples = 2;
    // Two boards 0.7 m before the camera, on either side of its axis, seen from the front.
    for (const double side : {-0.25, 0.0}) {
        sample_data::TargetView view;
        view.plane = sample_data::BoardPlane::Free;
        const Rigid& camera = bench.camera.bench_from_camera;
        view.plane_from_board.rotation = camera.rotation;
        view.plane_from_board.translation_m =
            camera.translation_m + camera.rotation * glm::dvec3(side, -0.1, 0.75);
        bench.targets.views.push_back(view);
    }
    return bench;
}

LabFrames boards_of(const sample_data::Bench& bench) {
    LabFrames lab(bench);
    for (const double exposure_us : {20000.0, 100000.0})
        lab.add(ShotKind::Dark, exposure_us, 4);
    for (int view = 0; view < 2; ++view)
        lab.add(ShotKind::Target, 100000.0, 1, glm::ivec2(-1), view);
    return lab;
}

calibrate::VeilResult veil_of_lab(const LabFrames& lab, rig::Radiometry& radiometry) {
    const calibrate::DarkResult dark =
        calibrate::dark_of(lab.groups(ShotKind::Dark), lab.layout(), lab.reader(), 8.0);
    radiometry.gain_e_per_dn = 2.7;
    radiometry.read_noise_dn = 2.06;
    radiometry.saturation_dn = 3800;
    std::vector<const capture::FrameRecord*> targets;
    for (const calibrate::ExposureGroup& group : lab.groups(ShotKind::Target))
        targets.insert(targets.end(), group.frames.begin(), group.frames.end());
    return calibrate::veil_of_targets(targets, lab.layout(), dark, radiometry, lab.reader());
}

TEST(Veil, ShareAndWidthAreFoundFromBoards) {
    const LabFrames lab = boards_of(veil_bench(0.03));
    rig::Radiometry radiometry;
    const calibrate::VeilResult veil = veil_of_lab(lab, radiometry);
    EXPECT_TRUE(veil.is_significant);
    // Beside counts: bench and blur are made of blocks, each wrong by up to 2 % of the veil.
    EXPECT_NEAR(veil.share, 0.03, 3.0 * veil.share_sigma + 0.03 * 0.03);
    EXPECT_NEAR(veil.sigma_px, 24.0, 3.0 * veil.sigma_sigma_px + 0.04 * 24.0);
    EXPECT_LT(veil.share_sigma, 0.003);
}

TEST(Veil, WhatIsLeftBesideABrightBoardIsATenthOfWhatWasThere) {
    const LabFrames lab = boards_of(veil_bench(0.03));
    rig::Radiometry radiometry;
    const calibrate::VeilResult veil = veil_of_lab(lab, radiometry);
    radiometry.veil_share = veil.share;
    radiometry.veil_sigma_px = veil.sigma_px;
    const sample_data::Prepared without = sample_data::prepare(veil_bench(0.0));
    const std::vector<float>& seen = lab.prepared->targets[0];
    const std::vector<float>& truth = without->targets[0];
    const std::vector<float> clear = rig::remove_veil(seen, {160, 128}, radiometry);
    double before = 0, after = 0, bright = 0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
        bright = std::max<double>(bright, truth[k]);
        if (truth[k] > 0.0F)
            continue;
        before += double(seen[k]) * seen[k];
        after += double(clear[k]) * clear[k];
    }
    EXPECT_GT(std::sqrt(before), 0.0);
    EXPECT_LT(std::sqrt(after), 0.1 * std::sqrt(before));
    RecordProperty("residual_of_veil", std::to_string(std::sqrt(after / before)));
}

TEST(Veil, ALensWithoutVeilGetsNone) {
    const LabFrames lab = boards_of(veil_bench(0.0));
    rig::Radiometry radiometry;
    const calibrate::VeilResult veil = veil_of_lab(lab, radiometry);
    EXPECT_FALSE(veil.is_significant);
    EXPECT_LT(std::abs(veil.share), 0.001);
}

}  // namespace
}  // namespace nearfield::test
