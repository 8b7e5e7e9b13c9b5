// SPDX-License-Identifier: Apache-2.0
/// How far a calibration is from the truth, beside what it says of itself.
#pragma once

#include "app/bench/calibration_truth.h"
#include "calibrate/geometry.h"

namespace nearfield::bench {

/// Found minus true, and the sigma that was predicted for it.
struct CheckedError {
    double error = 0, sigma = 0;
};

struct CalibrationErrors {
    CheckedError delta_rel, focal_rel;  // focal: fx
    /// RMS over the picture of how far apart both lenses see far points, the turn of the camera
    /// that brings them nearest removed; and what calibration predicts for it.
    double projection_px = 0, projection_predicted_px = 0;
    /// RMS angle between true and found direction of rays from a filter position to where a pixel
    /// sees S, in the slab's frame, over all positions and the whole picture.
    double direction_rad = 0;
    double direction_parallel_rad = 0;  // the same, if positions are taken to be at z = -delta
};

/// `found` has planes.
CalibrationErrors errors_of(const calibrate::Geometry& found, const CalibrationTruth& truth);

}  // namespace nearfield::bench
