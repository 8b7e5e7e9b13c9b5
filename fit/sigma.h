// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/solve.h"

namespace nearfield::fit {

/// Fills fit.sigma from the factor and gradient that solve_texel left in `work`.
///
///     free    X = N_FF^-1;  covariance of c_F = X (G^T W G)_FF X = X - lambda X (D^T Q D)_FF X
///     bound   s = N_mm - N_mF X N_Fm;  freed alone it would be -g_m / s, with variance 1 / s
///
/// For lambda > 0 the first is the spread that noise gives, without what smoothing leaves out, the
/// second an upper bound of it.
void fill_sigma(const Penalty& penalty, Workspace& work, TexelFit& fit);

/// Root mean square of a normal distribution of mean -ratio and sigma 1, cut off below 0.
double one_sided_rms(double ratio);

}  // namespace nearfield::fit
