// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/model/profile.h"
#include "sample_data/bench/bench.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace nearfield::test {

/// A bench that is prepared in a fraction of a second: 3 x 3 positions, 40 x 30 pixels, oblique
/// camera beyond the screen, everything tilted, the lamp a little behind the filter.
inline sample_data::Bench small_bench() {
    sample_data::Bench bench;
    bench.delta_m = 0.25;
    bench.lamp.u_from_lamp.translation_m = {0.003, -0.002, -0.015};
    bench.filter.profile = model::make_profile("bspline");
    bench.filter.grid = {3, 3};
    bench.filter.pitch_m = {0.03, 0.025};
    bench.filter.center_m = {0.004, -0.003};
    bench.filter.transmission = {0.9, 0.8, 0.7};
    bench.filter.tilt_deg = {6.0, -8.0};
    bench.filter.stage_scale = {1.02, 0.97};
    bench.filter.stage_skew_deg = 2.0;
    bench.screen.min_m = {-0.24, -0.15};
    bench.screen.max_m = {0.24, 0.10};
    bench.screen.tilt_deg = {10.0, 8.0};
    bench.screen.reflectance = {0.7, 0.8, 0.9};
    bench.screen.lobe_share = 0.3;
    bench.camera.size_px = {40, 30};
    bench.camera.fx_px = 60;
    bench.camera.fy_px = 61;
    bench.camera.cx_px = 20.5;
    bench.camera.cy_px = 14.5;
    bench.camera.k1 = -0.1;
    bench.camera.k2 = 0.05;
    bench.camera.p1 = 0.002;
    bench.camera.p2 = -0.001;
    // Turned half about x (it looks back at the lamp), then by asin(0.28) about y.
    bench.camera.bench_from_camera.rotation = {0.96, 0, -0.28, 0, -1, 0, -0.28, 0, -0.96};
    bench.camera.bench_from_camera.translation_m = {0.2, -0.02, 0.7};
    bench.camera.vignetting = {-0.1, 0.02, -0.01};
    bench.camera.response_e_per_cd_m2_s = {150, 0, 0, 250, 0, 0, 90, 0, 0};
    bench.accuracy.screen_step_px = 0.5;
    bench.accuracy.subsamples = 3;
    return bench;
}

/// A camera before an even source: every pixel has the same signal.
inline sample_data::Bench even_bench() {
    sample_data::Bench bench = small_bench();
    bench.setup = sample_data::Setup::Direct;
    bench.filter.grid = {1, 1};
    bench.camera.size_px = {64, 64};
    bench.camera.vignetting_cos4 = 0.0;
    bench.camera.vignetting = glm::dvec3(0.0);
    bench.camera.bits = 14;
    bench.camera.black_level_dn = 200;
    bench.flat_cd_m2 = 100.0;  // 49,000 electrons per second
    return bench;
}

inline double mean_of(const std::vector<float>& values) {
    double sum = 0.0;
    for (const float value : values)
        sum += value;
    return sum / static_cast<double>(values.size());
}

}  // namespace nearfield::test
