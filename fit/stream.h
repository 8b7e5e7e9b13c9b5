// SPDX-License-Identifier: Apache-2.0
/// A light field's fit, rows of texels at a time: memory is that of a tile, whatever the size.
#pragma once

#include "fit/solve.h"
#include "fit/texel_data.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace nearfield::fit {

/// What a tile's fit gives. Arrays are [channel][m][j][i] or [channel][j][i].
struct TileResult {
    TileRange rows;
    std::vector<float> coeffs;
    std::vector<float> sigma;  // empty where not asked for
    std::vector<float> chi_square, kkt_rel;
    std::vector<std::int16_t> valid_count, free_count;
};

/// Numbers of many texels: histograms and sums of integers, which add in any order.
struct FitReport {
    std::int64_t texel_count = 0;        // texels times channels
    std::int64_t unconverged_count = 0;  // KKT residual above FitOptions::kkt_limit
    std::int64_t unseen_count = 0;       // no valid measurement: coefficients 0
    std::int64_t valid_count = 0, free_count = 0, factorizations = 0;
    double kkt_worst = 0;
    std::array<std::int64_t, 20> kkt_decades{};  // [d]: 1e-d-1 < kkt <= 1e-d; last: all below
    double chi_square = 0;                       // sum over texels and channels, in row order

    /// Chi-square by degree of freedom: measurements less free coefficients.
    double reduced_chi_square() const;
    /// A bound that at least `share` of all texels keep: a power of ten.
    double kkt_quantile(double share) const;
};

/// Adds a later tile's numbers.
FitReport merged(const FitReport& a, const FitReport& b);

struct FitOptions {
    SolveOptions solve;
    int channels = 1;
    bool keeps_light = false;    // of every texel, summed over its measurements (keep_light.h)
    double model_error_rel = 0;  // what rig and basis get wrong, of a texel's brightest measurement
    double kkt_limit = 1e-6;
    double tile_bytes = 256e6;  // of a tile's input and result
};

using ReadTile = std::function<TileInput(TileRange rows)>;
using WriteTile = std::function<void(const TileResult& tile)>;

/// Throws Error naming the option that is out of range.
void check(const FitOptions& options);

/// Rows of a tile that keep within tile_bytes, at least one.
int tile_rows(const Design& design, const FitOptions& options);

/// One tile. Throws Error if the input's sizes do not fit, a value is not finite where its variance
/// is, or a variance is NaN or not positive.
/// Cost    that of solve_texel for every texel and channel; sigma doubles it. Parallel over rows
/// (TBB).
TileResult solve_tile(const Design& design,
                      const FitOptions& options,
                      TileRange rows,
                      const TileInput& input,
                      FitReport& report);

/// All texels: reads, solves and writes tiles in order, reader and writer from the calling thread.
/// The result does not depend on tile size or thread count.
FitReport solve_lightfield(const Design& design,
                           const FitOptions& options,
                           const ReadTile& read,
                           const WriteTile& write,
                           const std::function<void(double fraction)>& progress = {});

}  // namespace nearfield::fit
