// SPDX-License-Identifier: Apache-2.0
/// What `bench calibration` measures: how the error of a calibrated geometry grows with what goes
/// wrong on a bench, and whether its sigmas say so.
///
/// Corners are computed by formula, with noise; no pictures are made. Trials differ in the noise,
/// the boards' poses and the stage's errors; all settings of a sweep see the same trials.
#pragma once

#include "app/bench/calibration_errors.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::bench {

struct CalibrationSweepOptions {
    bool quick = false;  // few settings and trials: seconds, and no conclusions
    int trials = 0;      // of each setting; 0: 20, quick 3
    std::uint32_t seed = 0;
};

/// What calibration's own checks say; only where a sweep asks for them.
struct CalibrationChecks {
    double held_out_px = 0;        // RMS of views that the lens was not fitted to
    double halves_ratio = 0;       // difference of two halves' lenses over what sigmas predict
    double bend_significance = 0;  // of the board's bend, in sigmas
};

struct CalibrationTrial {
    int trial = 0;
    std::string refused;  // the program's message; empty: it calibrated
    CalibrationErrors errors;
    double corner_sigma_px = 0;  // as estimated
    double rms_px = 0;           // of residuals
    double time_s = 0;           // of calibrate_geometry without validation
    std::optional<CalibrationChecks> checks;
};

/// One setting of a sweep, and all its trials.
struct CalibrationSetting {
    std::string sweep;    // "noise", "boards", "bend", "tilt", "lens"
    std::string series;   // what a curve stands for: "bend ignored"; of the lens: the true model
    std::string setting;  // as text, with unit
    double value = 0;     // what is varied: px, boards, m, rad; of the lens: 0
    TruthOptions truth;
    double corner_sigma_px = 0.05;
    calibrate::GeometryOptions options;
    bool with_checks = false;
    std::vector<CalibrationTrial> trials;
};

struct CalibrationFindings {
    std::vector<CalibrationSetting> settings;  // sweep by sweep, each in order
    int trials = 0;
    double time_s = 0;
};

CalibrationFindings run_calibration_sweeps(const CalibrationSweepOptions& options,
                                           const std::function<void(double fraction)>& progress);

/// How a run was made, for the reader of the files.
struct CalibrationSetup {
    std::string command_line;
    std::string machine;  // CPU and cores
    bool quick = false;
};

/// One line a trial: sweep,series,setting,value,trial, errors with their sigmas, checks, time_s.
std::string as_csv(const CalibrationFindings& findings);

/// One self-contained page, without scripts.
void write_page(const CalibrationFindings& findings,
                const CalibrationSetup& setup,
                const std::string& path);

}  // namespace nearfield::bench
