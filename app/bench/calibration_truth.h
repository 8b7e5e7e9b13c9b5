// SPDX-License-Identifier: Apache-2.0
/// A bench by formula whose geometry is known, and what its camera would report of it: what
/// `bench calibration` compares calibrations with.
///
/// Frames as in CONVENTIONS.md: slab, bench camera, board (calibrate/observations.h). Everything is
/// drawn by hashes of (seed, trial, what it is for).
#pragma once

#include "calibrate/observations.h"
#include "formats/files/lightfield.h"
#include "formats/rig/lens.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace nearfield::bench {

struct TruthOptions {
    rig::LensModel lens_model = rig::LensModel::Brown5;
    bool is_wide = false;        // false: 48 degrees across the diagonal; true: 85 to 104
    int free_views = 12;         // besides two boards on S and two on U
    double bend_m = 0;           // of the board along its width; half of it along its height
    double u_tilt_rad = 0.005;   // of U against S, about an axis between x and y
    double step_sigma_m = 2e-5;  // of the filter's positions, by axis
    std::uint32_t seed = 0, trial = 0;
};

struct TruthView {
    capture::TargetPlane plane = capture::TargetPlane::Free;
    Rigid camera_from_board;
};

struct CalibrationTruth {
    rig::Lens lens;
    Rigid camera_from_slab;
    double delta_m = 0;
    glm::ivec2 grid{0};
    glm::dvec2 pitch_m{0.0};
    std::vector<glm::dvec3> center_slab;  // of the filter, [row * columns + column]
    double bend_m = 0;
    std::vector<TruthView> views;
};

/// The board: 8 x 6 squares of 30 mm, 35 corners.
CalibrationTruth make_calibration_truth(const TruthOptions& options);

/// What is seen in the picture, with gaussian noise of this sigma along each axis; filter centers
/// (nine positions) have 0.02 px.
calibrate::Observations observe(const CalibrationTruth& truth,
                                double corner_sigma_px,
                                std::uint32_t seed,
                                std::uint32_t trial);

}  // namespace nearfield::bench
