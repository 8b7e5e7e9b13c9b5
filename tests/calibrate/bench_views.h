// SPDX-License-Identifier: Apache-2.0
/// Pictures of the virtual bench's board, and where its corners really are.
#pragma once

#include "calibrate/targets.h"
#include "sample_data/bench/places.h"

#include <algorithm>
#include <string>
#include <vector>

namespace nearfield::test {

/// The bench of a file, its targets alone: quick to prepare.
inline sample_data::Bench target_bench(const std::string& name) {
    sample_data::Bench bench =
        sample_data::read_bench(std::string(NEARFIELD_SOURCE_DIR) + "/sample_data/" + name);
    bench.setup = sample_data::Setup::Direct;
    bench.filter.grid = {1, 1};
    return bench;
}

inline capture::BoardPlan board_of(const sample_data::Bench& bench) {
    const sample_data::BenchBoard& board = bench.targets.board;
    return {capture::BoardKind::Charuco, board.squares, board.square_m, board.marker_m, "4x4_50"};
}

/// A picture of a view, its white at 70 % of full well.
inline capture::Frame exposed(const sample_data::PreparedBench& prepared, std::size_t view) {
    const sample_data::Bench& bench = sample_data::bench_of(prepared);
    sample_data::Shot shot;
    shot.subject = sample_data::Subject::Target;
    shot.target_view = static_cast<int>(view);
    shot.frame_number = view;
    const std::vector<float> signal = sample_data::signal_e_per_s(prepared, shot);
    const double brightest = *std::max_element(signal.begin(), signal.end());
    shot.exposure_us = 0.7e6 * bench.camera.full_well_e / brightest;
    return {bench.camera.size_px, 1, bench.camera.bits, sample_data::expose(prepared, shot)};
}

/// Where the camera sees a point of the bench.
inline glm::dvec2 seen_px(const sample_data::Bench& bench, glm::dvec3 p_bench) {
    const Rigid camera_from_bench = inverse(bench.camera.bench_from_camera);
    return *sample_data::project_px(bench.camera, apply(camera_from_bench, p_bench));
}

}  // namespace nearfield::test
