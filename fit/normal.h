// SPDX-License-Identifier: Apache-2.0
/// The normal equations of one texel: N = G^T W G + lambda D^T Q D.
#pragma once

#include "fit/design.h"

#include <span>
#include <vector>

namespace nearfield::fit {

/// Differences between neighbors on the basis grid, each a row of D: sum_p stencil[p] c[first + p
/// step].
struct Penalty {
    struct Difference {
        int first = 0, step = 0;
    };
    std::vector<double> stencil;
    std::vector<Difference> differences;
    int reach = 0;  // farthest neighbor along an axis
};

/// Order 1 (1, -1) or 2 (1, -2, 1), along x and along y of a W x H grid.
Penalty difference_penalty(glm::ivec2 grid, int order);

struct NormalEquations {
    int size = 0;
    int leading = 0;               // distance of columns
    std::vector<double> lower;     // N, column by column; entries above the diagonal mean nothing
    std::vector<double> rhs;       // G^T W b, and zeros to `leading`
    std::vector<double> norm;      // [m]: sqrt(N_mm); 0: nothing sees it
    double data_norm = 0;          // sqrt(b^T W b)
    std::vector<double> weighted;  // W G, as TexelDesign::value
    std::vector<double> penalty_weight;  // [difference]: lambda q; empty: lambda is 0
    int valid_count = 0;                 // of measurements with weight

    double entry(int row, int column) const {
        return lower[static_cast<std::size_t>(column) * static_cast<std::size_t>(leading) +
                     static_cast<std::size_t>(row)];
    }
};

/// Writes N and its right side over what was there: tiles of N, each summed in registers over all
/// measurements that reach it.
void form_normal(const TexelDesign& texel,
                 const Penalty& penalty,
                 std::span<const double> b,
                 std::span<const double> weight,
                 double lambda,
                 NormalEquations& normal);

/// Half the gradient of what is minimized, N c - G^T W b, from the columns of N down to
/// row_end[column].
void fill_gradient(const std::vector<double>& coeffs,
                   const std::vector<int>& row_end,
                   const NormalEquations& normal,
                   std::vector<double>& gradient);

/// The same as G^T W (G c - b) + lambda D^T Q D c, from G and b, not from N. `coeffs` and
/// `gradient` have leading entries, `residual` (G c - b) one a measurement.
void fill_gradient(const TexelDesign& texel,
                   const Penalty& penalty,
                   std::span<const double> b,
                   std::span<const double> weight,
                   const NormalEquations& normal,
                   const std::vector<double>& coeffs,
                   std::vector<double>& residual,
                   std::vector<double>& gradient);

}  // namespace nearfield::fit
