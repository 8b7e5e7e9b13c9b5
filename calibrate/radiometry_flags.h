// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/radiometry.h"

namespace nearfield::calibrate {

/// What of the sensor's numbers people should know.
void flag_sensor(const SortedFrames& frames, RadiometryResult& result);
void flag_filter(RadiometryResult& result);
void flag_scale(RadiometryResult& result);

/// The numbers, with sigma.
void list_sensor(RadiometryResult& result);

}  // namespace nearfield::calibrate
