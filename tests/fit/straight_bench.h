// SPDX-License-Identifier: Apache-2.0
/// A bench that is known exactly: a camera that looks straight at S, a filter on U, a lamp that is
/// itself a light field, a linear sensor without noise.
#pragma once

#include "fit/position_light.h"

#include <string>

namespace nearfield::fit {

struct StraightBench {
    glm::ivec2 size_px{48, 36};
    double pixel_m = 0.004;    // on S
    double beside_lx = 0;      // even light with a plate instead of the filter
    double lamp_rise_rel = 0;  // from the first look at the reference to the last position
    std::vector<double> exposures_us{10000, 40000};
    std::vector<glm::ivec2> left_out;  // positions without frames
    bool has_blocked_frames = true;
    int drift_every = 5;  // positions between looks at the reference
    double brightness = 1;
    double current_dn_per_s = 0;  // dark current at 20 C, from which the sensor rises
    double room_dn_per_s = 0;     // light that is always there
    double sensor_rise_c = 0;     // until the last frame
};

/// What it was measured with: 5 x 4 positions, 1 lux is 100 DN/s.
rig::Rig straight_rig(const StraightBench& bench);
rig::Maps straight_maps(const StraightBench& bench);

/// The lamp: its coefficients are the same in all texels but for a slope along x.
LightField straight_lamp(const StraightBench& bench);

/// Writes a capture of it into a new folder.
capture::Capture take_capture(const StraightBench& bench, const std::string& folder);

}  // namespace nearfield::fit
