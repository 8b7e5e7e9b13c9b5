// SPDX-License-Identifier: Apache-2.0
/// Least squares in the span of a light field's basis, for a whole row of texels at once.
#pragma once

#include "formats/files/lightfield.h"

#include <span>
#include <vector>

namespace nearfield::sample_data {

/// The basis along one axis: values, Gram matrix (banded), its inverse, integral of one function.
struct Axis {
    Profile profile;
    int count = 0;
    double pitch_m = 0, first_center_m = 0, integral_m = 0;
    std::vector<double> gram, inverse;  // count x count

    /// Offset in gram and inverse.
    std::size_t at(int k, int m) const {
        return static_cast<std::size_t>(k) * static_cast<std::size_t>(count) +
               static_cast<std::size_t>(m);
    }
    double value(int k, double u_m) const;
    /// Borders of all functions' cells, rising.
    std::vector<double> cell_edges_m() const;
};

/// Along x (dimension 0) or y (1). The functions must be linearly independent, as those of all
/// named profiles are. Cost    count^3.
Axis make_axis(const Slab& planes, int dimension);

/// One basis function's index and value at a point.
struct Term {
    int index = 0;
    double value = 0;
};

/// The functions that are not zero at u.
std::vector<Term> terms_at(const Axis& axis, double u_m);

/// Coefficients of one row of texels and one channel.
struct RowSolution {
    std::vector<double> coeffs;  // [m][i], >= 0
    double negative_m2 =
        0;  // sum over the unconstrained solution's negative coefficients of |c| * integral Phi
    double rescaled_m2 =
        0;  // sum over texels of |integral - integral of the solution before scaling|
};

/// Minimizes the integral of (f - sum c_m Phi_m)^2 under c >= 0 for every texel i, then scales each
/// texel's c to the integral of f. b is [m][i]: integrals of f Phi_m; integral is [i]: integrals of
/// f.
RowSolution solve_row(const Axis& axis_x,
                      const Axis& axis_y,
                      std::span<const double> b,
                      std::span<const double> integral);

}  // namespace nearfield::sample_data
