// SPDX-License-Identifier: Apache-2.0
/// A whole calibration: from a capture to a rig.
#pragma once

#include "calibrate/geometry.h"
#include "calibrate/radiometry.h"
#include "formats/capture/capture.h"
#include "formats/rig/rig.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::calibrate {

struct CalibrationOptions {
    GeometryOptions geometry;
    std::optional<double> assumed_black_dn;  // without darks: this level, no dark current
    std::function<void(const std::string& step, double fraction)> progress;
};

struct Calibration {
    rig::Rig rig;
    rig::Maps maps;
    std::optional<Geometry> geometry;
    std::optional<RadiometryResult> radiometry;
    std::vector<Flag> flags;  // of both, with what to do
    double boards_s = 0;      // time to find the boards
};

/// What the capture holds is calibrated: views of a board give the lens, boards on S and U and
/// views of the filter the planes, darks and flats the sensor, a photometer's readings the scale;
/// a bracket of photographs their response.
///
/// Throws Error, with what to do, where there is nothing to calibrate, or where what was planned
///        does not suffice.
Calibration calibrate_capture(const std::string& folder,
                              const capture::Capture& capture,
                              const CalibrationOptions& options);

}  // namespace nearfield::calibrate
