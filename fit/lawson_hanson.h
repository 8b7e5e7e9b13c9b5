// SPDX-License-Identifier: Apache-2.0
/// Non-negative least squares of a dense matrix a, [row][column]: what solve.h is compared with,
/// and its oracle: it knows nothing of bands, blocks, warm starts or normal equations.
///
/// Columns come in one at a time, the one that would gain most first, and leave where they would
/// turn negative. Two ways to keep the least squares of the columns that are in:
///
///     fresh    a Householder QR factorization of them at every exchange, as MATLAB's lsqnonneg and
///              most short implementations do
///     updated  one factorization for all: a Householder reflection for a column that comes in,
///              Givens rotations for one that leaves, as the authors' own program does
///
/// Source    Lawson and Hanson, "Solving least squares problems", 1974, algorithm NNLS.
#pragma once

#include <span>
#include <vector>

namespace nearfield::fit {

enum class LeastSquares { Fresh, Updated };

/// Cost    11 x 9 positions and as many columns: milliseconds fresh, 0.3 ms updated.
std::vector<double> lawson_hanson(std::span<const double> a,
                                  std::span<const double> b,
                                  int columns,
                                  LeastSquares kept);

}  // namespace nearfield::fit
