// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/scale.h"

#include <optional>
#include <span>

namespace nearfield::calibrate {

/// Light that is not the lamp's through the filter.
///
/// Room light on S is in the darks and goes with them. Its size is known from a photometer's
/// readings with the lamp off; without them the darks bound it: all of a pixel's dark rate could be
/// room light. Darks under a cap, which would tell the two apart, are not part of a capture.
///
/// Light beside the filter cannot be told from the lamp's own far light. The darkest part of a
/// frame bounds it: it can be no brighter, if it is even.
struct StrayResult {
    double room_lx = 0, room_sigma_lx = 0;
    bool is_room_measured = false;
    double room_bound_lx = 0;  // the median pixel's dark rate as light; in DN/s without a scale
    /// What flats, boards and filter views lose by darks that see a lit screen, at most: median
    /// dark rate over the flats' rate.
    double flat_bound_rel = 0;
    /// Even light in a frame over the light that its filter position holds back: the least that
    /// parts of the screen see, which other positions light, and three sigma of noise.
    double beside_bound = 0;
    bool has_beside_bound = false;
};

/// In      flat_rate_dn_per_s: of the flats; filter: its profile with peak 1, and that peak; none:
/// no
///         bound for light beside it.
/// Cost    reads each bracket's shortest and longest frame.
StrayResult stray_of(std::span<const Bracket> brackets,
                     std::span<const ExposureGroup> darks,
                     const PixelLayout& layout,
                     const DarkResult& dark,
                     const rig::Radiometry& radiometry,
                     const rig::Maps& maps,
                     double flat_rate_dn_per_s,
                     const std::optional<Profile>& filter,
                     double filter_peak,
                     const FrameReader& read);

}  // namespace nearfield::calibrate
