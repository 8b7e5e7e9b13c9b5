// SPDX-License-Identifier: Apache-2.0
/// How smooth a light field ought to be, asked of measurements that the fit has not seen.
#pragma once

#include "fit/stream.h"

#include <vector>

namespace nearfield::fit {

struct SmoothnessOptions {
    std::vector<double> lambdas = {0,    1e-6, 3e-6, 1e-5, 3e-5, 1e-4,
                                   3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1};
    int folds = 5;           // positions are dealt out to as many groups
    int texel_step = 1;      // every texel_step-th texel of a row is asked
    std::uint64_t seed = 1;  // of the dealing out
};

/// Chi-square by held-out measurement, against lambda.
struct SmoothnessCurve {
    std::vector<double> lambda, chi_square;
    std::vector<double> sigma;  // of the mean's difference from the best lambda's, over texels
    std::size_t best = 0;       // of least chi-square
    std::int64_t held_out_count = 0;
};

/// Group of every position: each has count / folds positions or one more.
std::vector<int> folds_of(int measurement_count, int folds, std::uint64_t seed);

/// Cross-validation: for each group in turn, the fit of all others foretells its measurements.
///
/// In      a tile of the data, of FitOptions::channels; difference_order is taken from
///         `options.solve`.
/// Throws  Error if there is no lambda, folds < 2 or more folds than measurements, or no datum.
/// Cost    lambdas x folds fits of the texels asked. Parallel over rows (TBB).
SmoothnessCurve cross_validate(const Design& design,
                               const FitOptions& options,
                               const SmoothnessOptions& smoothness,
                               TileRange rows,
                               const TileInput& input);

}  // namespace nearfield::fit
