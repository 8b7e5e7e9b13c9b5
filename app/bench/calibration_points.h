// SPDX-License-Identifier: Apache-2.0
/// Trials of `bench calibration` taken together, and what follows from them.
#pragma once

#include "app/bench/calibration.h"

#include <optional>
#include <string>
#include <vector>

namespace nearfield::bench {

/// Quartiles over trials.
struct Quartiles {
    double low = 0, median = 0, high = 0;
};

/// An error's size over trials, and what calibration said that it would be.
struct ErrorSize {
    Quartiles size;
    double predicted = 0;  // the median of the predicted sigmas
    double scale = 0;      // RMS of error over its own sigma: 1 where sigmas are right
};

struct CalibrationPoint {
    std::string series, setting;
    double value = 0;
    int calibrated = 0, refused = 0;  // trials
    ErrorSize delta_rel, focal_rel, projection_px;
    Quartiles direction_rad, direction_parallel_rad, time_s;
    std::optional<CalibrationChecks> checks;  // medians
};

/// Of a sweep's settings where at least one trial calibrated, in order; series empty: of all.
std::vector<CalibrationPoint> points_of(const CalibrationFindings& findings,
                                        const std::string& sweep,
                                        const std::string& series = "");

/// What follows from a sweep's numbers, in sentences; "sigma": whether sigmas are right.
std::vector<std::string> calibration_conclusions(const CalibrationFindings& findings,
                                                 const std::string& sweep);

}  // namespace nearfield::bench
