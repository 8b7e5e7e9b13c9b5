// SPDX-License-Identifier: Apache-2.0
/// The light of a capture's positions, pixel by pixel.
#pragma once

#include "fit/merge.h"
#include "formats/capture/capture.h"
#include "formats/rig/rig.h"

#include <glm/glm.hpp>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::fit {

/// A capture and the rig that it was taken with.
struct Measurement {
    std::string folder;
    const capture::Capture& capture;
    const rig::Rig& rig;
    const rig::Maps& maps;
};

/// All frames of a position, every exposure and repeat.
struct PositionFrames {
    glm::ivec2 position{0};  // of the stage: column, row
    std::vector<const capture::FrameRecord*> frames;
};

/// The positions that have frames, row by row.
std::vector<PositionFrames> positions_of(const capture::Capture& capture);

/// The frames with an opaque plate instead of the filter; none where the plan asked for none.
PositionFrames blocked_frames(const capture::Capture& capture);

/// Throws Error where the rig cannot be that of the capture (other picture size, bits or stage
/// grid), or its maps hold what is no number.
void check_rig(const Measurement& measurement);

/// When a frame was exposed, by the camera's own clock; of cameras without one, since the session's
/// start.
double time_s(const capture::FrameRecord& frame);

/// The lamp's light at a frame's time over that of the first look at the reference; 1 where a
/// session has no look.
class LampDrift {
  public:
    /// Throws Error where the first look is saturated all over, or dark.
    explicit LampDrift(const Measurement& measurement);

    double factor(const capture::FrameRecord& frame) const;
    int looks() const { return looks_; }
    double largest_rel() const { return largest_rel_; }

  private:
    std::map<int, std::vector<std::pair<double, double>>> by_session_;  // time, s; factor
    int looks_ = 0;
    double largest_rel_ = 0;
};

/// Merged light of a position in DN/s of pixels of response 1: drift and the lens' veil taken off.
/// Bad pixels are bridged by their neighbors, whose spread becomes variance. Saturated ones have
/// infinite variance; for the veil that they spread their neighbors stand in.
MergedImage position_light(const Measurement& measurement,
                           const PositionFrames& position,
                           const LampDrift& drift);

}  // namespace nearfield::fit
