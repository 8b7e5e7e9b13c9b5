// SPDX-License-Identifier: Apache-2.0
/// The coefficients of one texel and channel: weighted non-negative least squares with smoothness.
///
///     minimize  sum_k w_k (b_k - sum_m G_km c_m)^2 + lambda sum_d q_d (D c)_d^2,   c >= 0
///
/// w_k = 1 / variance, 0 where a measurement is missing or saturated. D: differences of first or
/// second order between neighbors on the basis grid, along x and along y. q_d is the harmonic mean
/// of (G^T W G)_mm over the difference's coefficients: what the data know of the least known of
/// them. So lambda has no unit, and one lambda does for all texels, bright or dark: a solution does
/// not change when light and noise are scaled.
///
/// Method    Block principal pivoting on the normal equations: the free coefficients are solved for
///           by a Cholesky factor that follows them (free_factor.h); those that break a condition
///           change sides all at once. Where that goes round in circles (nearly singular problems)
///           the primal active-set method ends it. The residual of the Karush-Kuhn-Tucker
///           conditions proves the minimum; it is computed from G and b, not from the factored
///           matrix.
/// Source    Portugal, Judice, Vicente, "A comparison of block pivoting and interior-point
///           algorithms for linear least squares problems with nonnegative variables", 1994; Kim
///           and Park, "Fast nonnegative matrix factorization: an active-set-like method and
///           comparisons", 2011.
#pragma once

#include "fit/design.h"
#include "fit/free_factor.h"
#include "fit/normal.h"

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::fit {

struct SolveOptions {
    double lambda = 0;         // >= 0; larger is smoother
    int difference_order = 2;  // 1 or 2
    bool wants_sigma = false;
};

/// The solution of a texel; its memory and its set of free coefficients serve for the next texel.
struct TexelFit {
    std::vector<std::uint8_t> is_free;  // [m]; in: where to start, empty: all free
    std::vector<double> coeffs;         // [m], >= 0
    /// [m], where asked for: standard deviation from the measurements' noise, with the set of free
    /// coefficients as it is. Of a coefficient at the bound 0 it is one-sided: the root mean square
    /// of a normal distribution around the value that it would take if it were free, cut off below
    /// 0. Infinity: no measurement sees it and nothing ties it to one that does.
    std::vector<double> sigma;
    /// Largest breach of the conditions of the minimum: |cosine| between residual and column of G,
    /// with the data's length for the residual's: |g_m| / (sqrt(N_mm) sqrt(b^T W b)).
    double kkt_rel = 0;
    double chi_square = 0;  // sum of w (b - G c)^2
    int valid_count = 0, free_count = 0, factorizations = 0;
    bool has_converged = true;
};

/// Memory of a solver; one a thread, for any number of texels.
struct Workspace {
    NormalEquations normal;
    Band band;
    FreeFactor factor;
    std::vector<std::size_t> breaches;
    std::vector<double> coeffs_padded, gradient, residual, right_side, lanes;
};

/// Fits b with weights w, [k]. The texel's G may be shared by all channels. noise_share: of 1 / w,
/// what is noise and makes sigma, [k]; empty: all of it.
/// Throws Error if a value is not finite or a weight is negative or not finite.
/// Cost    11 x 9 positions, B-splines, 4.3 sets of free coefficients: 80 to 110 us of a core on a
///         busy machine (`nearfield bench fit`): a quarter forms N, a third factors it.
void solve_texel(const TexelDesign& texel,
                 const Penalty& penalty,
                 std::span<const double> b,
                 std::span<const double> weight,
                 const SolveOptions& options,
                 Workspace& work,
                 TexelFit& fit,
                 std::span<const double> noise_share = {});

}  // namespace nearfield::fit
