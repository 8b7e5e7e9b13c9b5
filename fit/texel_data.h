// SPDX-License-Identifier: Apache-2.0
/// One texel's measurements out of a tile, and what each is worth.
#pragma once

#include "fit/design.h"

#include <cstddef>
#include <vector>

namespace nearfield::fit {

struct TileRange {
    int first_row = 0, row_count = 0;  // of texels, j
};

/// What was measured of a tile. Arrays are [channel][k][j][i].
struct TileInput {
    std::vector<float> value;
    std::vector<float> variance;  // of the noise; infinity: missing or saturated
};

/// Where a tile's arrays keep their values.
struct TileLayout {
    std::size_t width = 0, rows = 0, measurements = 0, functions = 0, channels = 0;

    /// Of measurement k or image m of `of_each` in a channel.
    std::size_t at(std::size_t channel,
                   std::size_t index,
                   std::size_t of_each,
                   std::size_t row,
                   std::size_t i) const {
        return ((channel * of_each + index) * rows + row) * width + i;
    }
    std::size_t texel(std::size_t channel, std::size_t row, std::size_t i) const {
        return (channel * rows + row) * width + i;
    }
};

TileLayout tile_layout(const Design& design, int channels, TileRange rows);

/// Arrays are [k]; what is missing has no weight.
struct TexelData {
    std::vector<double> b;
    std::vector<double> weight;       // 1 / (variance + error^2)
    std::vector<double> noise_share;  // variance * weight: all but the error of rig and basis
};

/// What rig and basis get wrong is the same for all positions, `model_error_rel` of the brightest:
/// it shapes the weights, and is no noise.
/// Out     false: nothing was measured
/// Throws  Error naming place if a variance is NaN or not positive.
bool read_texel(const TileInput& input,
                const TileLayout& layout,
                std::size_t channel,
                std::size_t row,
                std::size_t i,
                double model_error_rel,
                TexelData& data);

}  // namespace nearfield::fit
