// SPDX-License-Identifier: Apache-2.0
/// What a bench and a basis can tell, apart from noise.
#pragma once

#include "fit/stream.h"

#include <span>

namespace nearfield::fit {

/// How well one texel's coefficients are determined: eigenvalues of G^T W G, scaled to unit
/// diagonal.
struct Conditioning {
    double least = 0, most = 0;
    double condition = 0;  // most / least; infinity where a combination is not seen at all
    int unseen_count = 0;  // coefficients that no measurement sees
};

/// Cost    O(n^3): for some texels, not for all.
Conditioning conditioning(const TexelDesign& texel, std::span<const double> weight);

/// What noise-free data of this basis misses.
struct RepresentationError {
    double data_rms_rel = 0;    // fitted against true measurements, relative to their RMS
    double check_rms_rel = 0;   // the same of measurements that were not fitted
    double check_bias_rel = 0;  // (sum fitted - sum true) / sum true, of these
};

/// Fits noise-free measurements and looks at others, at best of another kind or between the
/// positions: pinholes or cameras there show L itself.
///
/// In      truth [channel][k][j][i] and its weights' variances, as they would be measured; check:
///         the same for `check_design`, variances not used
/// Throws  as solve_tile
RepresentationError representation_error(const Design& design,
                                         const FitOptions& options,
                                         TileRange rows,
                                         const TileInput& truth,
                                         const Design& check_design,
                                         const TileInput& check);

}  // namespace nearfield::fit
