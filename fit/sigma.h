// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/solve.h"

namespace nearfield::fit {

/// Fills fit.sigma from the factor and gradient that solve_texel left in `work`. Noise of variance
/// noise_share / weight goes through the estimate as it is, with its free coefficients, weights and
/// smoothing:
///
///     free    c_F = X G_F^T W b, X = N_FF^-1;    variance of c_m = sum_k share_k w_k (G_k x_m)^2
///     bound   freed alone it would be -g_m / s, s = N_mm - N_mF X N_Fm, with the variance
///             sum_k share_k w_k (G_k z)^2 / s^2, z = e_m - X N_Fm
///
/// What smoothing or the basis leave out is not in it.
/// In      noise_share: [k]; empty: all 1
/// Cost    O(n measurements entries of a row): as much as the fit
void fill_sigma(const TexelDesign& texel,
                std::span<const double> weight,
                std::span<const double> noise_share,
                Workspace& work,
                TexelFit& fit);

/// Root mean square of a normal distribution of mean -ratio and sigma 1, cut off below 0.
double one_sided_rms(double ratio);

}  // namespace nearfield::fit
