// SPDX-License-Identifier: Apache-2.0
/// Measurements as they might have been: other noise, and another calibration that the views of it
/// allow as well. Fits of them are replicates, whose spread is the sigma of whatever follows.
#pragma once

#include "fit/design.h"
#include "fit/texel_data.h"
#include "formats/rig/rig.h"

#include <cstdint>

namespace nearfield::fit {

/// Which replicate: equal ones draw equal numbers, whatever the tiles.
struct Draw {
    std::uint64_t seed = 1;
    std::uint32_t replicate = 0;
};

/// Adds noise of every measurement's variance.
void add_noise(const TileLayout& layout, TileRange rows, Draw draw, TileInput& tile);

/// The filter's places as the rig's covariance lets them be, all together: distance and tilt of U,
/// steps and skew of the stage, where the grid's middle lies on S and how it is turned. Without a
/// covariance they stay. A stage's error at every single position is not known to the rig.
/// Source    linear in the parameters; covariance by its eigenvectors
Optics drawn_optics(const Optics& optics, const rig::Rig& rig, Draw draw);

}  // namespace nearfield::fit
