// SPDX-License-Identifier: Apache-2.0
/// A camera of 2048 x 2048 pixels whose frames cost nothing but their bytes, and how fast they
/// come.
#pragma once

#include "acquire/camera.h"
#include "acquire/session.h"
#include "formats/files/provenance.h"
#include "sample_data/gige/pixel_format.h"
#include "tests/devices/test_lab.h"

#include <gtest/gtest.h>

#include <vector>

namespace nearfield::devices {

inline gige::Lab large_bench() {
    gige::Lab lab = test_bench();
    lab.sensor_px = {2048, 2048};
    lab.expose = [frame = std::vector<std::uint16_t>(2048 * 2048)](const gige::Exposure&) {
        return frame;
    };
    return lab;
}

/// What the simulated camera alone computes for a frame of Mono16, whatever the wire.
inline double far_end_s() {
    const gige::Lab lab = large_bench();
    constexpr int kFrames = 5;
    std::size_t bytes = 0;
    const double start_s = now_s();
    for (int k = 0; k < kFrames; ++k)
        bytes +=
            gige::pack(gige::PixelFormat::Mono16, gige::crop(lab.expose({}), lab.sensor_px, {0, 0},
                                                             lab.sensor_px, lab.sensor_bits, 16))
                .size();
    EXPECT_EQ(bytes, kFrames * 2048U * 2048U * 2U);
    return (now_s() - start_s) / kFrames;
}

/// Mono16, an exposure of 100 us that takes no time.
inline double large_frames_per_s(const acquire::Bench& bench) {
    capture::CameraPlan plan;
    plan.pixel_format = "Mono16";
    bench.camera->configure(plan);
    bench.camera->set_exposure(100);
    bench.camera->expose(never);  // the first one touches memory for the first time
    constexpr int kFrames = 20;
    const double start_s = now_s();
    for (int k = 0; k < kFrames; ++k)
        EXPECT_EQ(bench.camera->expose(never).frame.values.size(), 2048U * 2048U);
    return kFrames / (now_s() - start_s);
}

}  // namespace nearfield::devices
