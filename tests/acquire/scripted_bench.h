// SPDX-License-Identifier: Apache-2.0
/// A bench without a wire, which misbehaves as it is told: for the session's logic.
#pragma once

#include "acquire/session.h"

#include <functional>
#include <memory>

namespace nearfield::acquire {

/// What the bench does wrong, and what it counts. Frames are counted from 1 over the bench's life.
struct Script {
    int late_frames = 0;            // a new exposure shows so many frames later
    bool ignores_exposure = false;  // but reads it back
    double clamps_at_us = 1e12;     // reads this back
    double true_ratio = 1;          // what exposures above 1000 us are multiplied by
    int lost_at = 0;                // DeviceLost once at this frame
    int tries_to_come_back = 0;     // opening fails so often after that
    int incomplete_at = 0, incomplete_frames = 1, stale_at = 0;
    int drifts_from = 0;
    double drift_per_frame = 0;  // relative
    int stop_at = 0;             // Ctrl-C at this frame
    int stalled_at = 0;          // the stage throws at this frame

    int frames = 0, opened = 0;
};

/// Opens a bench that follows the script, which must live longer.
Bench open_scripted(Script& script);

}  // namespace nearfield::acquire
