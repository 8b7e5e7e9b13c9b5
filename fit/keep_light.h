// SPDX-License-Identifier: Apache-2.0
/// A fit that keeps a texel's light.
///
/// Least squares with coefficients >= 0 makes light where the basis cannot follow the lamp: what is
/// narrower than the basis' functions is fitted by a wider peak, and the sum over all positions
/// comes out too high (13 % with functions three times as wide as the beam). But that sum is what
/// is known best of all: behind filters whose transmissions add up to one it is the open lamp. So
/// all coefficients of a texel are multiplied by one factor, after which
///
///     sum over valid k of (G c - b)_k = 0
///
/// A factor leaves dark directions as dark, relative to bright ones, as they were found. (The same
/// condition by a Lagrange multiplier takes equal light from bright and dark measurements: it is
/// nearer to least squares, and dark directions then hang on how badly bright ones fit.)
#pragma once

#include "fit/solve.h"

namespace nearfield::fit {

/// In      work, fit: as solve_texel left them for these data
/// Out     fit: coefficients, sigma and chi-square of the kept light; work.residual: its residuals,
///         where there is a weight.
///         Where the data add up to nothing or less, all stays as it is.
/// Cost    O(measurements)
void keep_light(std::span<const double> b,
                std::span<const double> weight,
                Workspace& work,
                TexelFit& fit);

}  // namespace nearfield::fit
