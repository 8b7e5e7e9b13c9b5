// SPDX-License-Identifier: Apache-2.0
/// The windowed sum on coarser images: cheaper and smoothly less exact, by a number Q.
#pragma once

#include "formats/model/prepared.h"

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::model {

/// A slab at all its resolutions: [0] as it is, [l] with every 2^l x 2^l texels averaged
/// (MipLevel); all hold the same light. Where a size is odd S's rectangle grows with it.
struct PreparedMips {
    std::vector<PreparedSlab> levels;
};

/// Cost: a third of the slab's memory again.
PreparedMips prepare_mips(Slab slab);

/// The finest level on which a basis function's window on S spans at most q texels on its wider
/// side (so more than q / 2 of them); 0 where q is 0 (exact), the coarsest where none is coarse
/// enough.
int level_for(const PreparedMips& mips, const ReceiverF& receiver, int q);

/// What |E_q - E_2q| is multiplied by to bound E_q's error: 4/3 where the error falls with the
/// square of the texels' width, and a margin. On the reference lamp the error stays below it at all
/// receivers at q = 16 (E_2q is exact there), 99 % at q = 8, two thirds at q = 4; with a bilinear
/// basis 95 % at q = 8. Where it does not, light of a few texels was spread into the dark.
constexpr float kBiasPerDifference = 1.5F;

/// Unshadowed irradiance with windows of at most q texels a side; q = 0: exact. Arguments and
/// result as irradiance() of prepared.h; receivers are summed on the level of the first of them.
///
/// Error   bias alone. Reference lamp, relative RMS: q = 16 1.6 %, 12 3.5 %, 8 8.1 %, 4 45 %.
/// Cost    multiply-adds fall with the square of q, down to the windows' weights (a tenth of the
///         exact sum). From one level to the next the picture steps by |E_q - E_2q|: a blend of two
///         levels costs more than the exact sum, one with the coarser level adds to the error.
std::uint64_t irradiance(const PreparedMips& mips,
                         int q,
                         std::span<const ReceiverF> receivers,
                         std::span<glm::vec3> results,
                         std::span<float> image_y = {});

}  // namespace nearfield::model
