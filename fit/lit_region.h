// SPDX-License-Identifier: Apache-2.0
/// Which part of S a capture's light falls on.
#pragma once

#include "fit/position_light.h"
#include "fit/texel_plan.h"

#include <vector>

namespace nearfield::fit {

struct LitRegion {
    Extent extent;
    double outside_share = 0;  // of the light in the picture that falls beside the extent
};

/// From some positions together: middle, corners and middles of the edges.
///
/// In      wanted: this extent; none: what is brighter than dark_share of the brightest light
/// Throws  Error if there is no light at all, or all of it is saturated.
LitRegion lit_region(const Measurement& measurement,
                     const std::vector<PositionFrames>& positions,
                     const LampDrift& drift,
                     const std::optional<Extent>& wanted,
                     double dark_share);

}  // namespace nearfield::fit
