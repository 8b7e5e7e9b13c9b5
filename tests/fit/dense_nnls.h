// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace nearfield::fit {

/// Non-negative least squares of a dense matrix a, [row][column]: an oracle that knows nothing of
/// bands, blocks, warm starts or normal equations. Householder columns come in one at a time and
/// leave by Givens rotations.
/// Source    Lawson and Hanson, "Solving least squares problems", 1974, algorithm NNLS.
std::vector<double> dense_nnls(std::span<const double> a, std::span<const double> b, int columns);

}  // namespace nearfield::fit
