// SPDX-License-Identifier: Apache-2.0
/// What a camera makes of light: exposures with noise, merged as the fit merges them.
#pragma once

#include "fit/stream.h"

#include <cstdint>
#include <vector>

namespace nearfield::bench {

/// A bracket: the shortest exposure brings the brightest light to three quarters of saturation,
/// every other is four times as long as the one before.
struct Bracket {
    int exposures = 3;
    int frames = 1;  // of each, averaged
};

/// In      light [k][j][i], any unit; missing [k]: positions that were not measured
/// Out     a tile of one channel with merged values and variances, infinite where saturated or
///         missing. A sensor of 12 bits, 2.4 electrons and 2.6 DN read noise; a pixel a texel.
/// Cost    a merge of `exposures` values a texel and position. Parallel over positions (TBB).
fit::TileInput photographed(const std::vector<double>& light,
                            const std::vector<bool>& missing,
                            const Bracket& bracket,
                            std::uint32_t seed);

}  // namespace nearfield::bench
