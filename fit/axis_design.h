// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/design.h"

#include <vector>

namespace nearfield::fit {

/// The basis functions along one axis of U.
struct AxisBasis {
    const Profile* profile = nullptr;
    int count = 0;
    double pitch_m = 0, first_center_m = 0;
};

/// A filter along one axis, as it is seen on U.
struct AxisFilter {
    const Profile* profile = nullptr;
    double center_m = 0, pitch_m = 0;
};

AxisBasis axis_basis(const Slab& planes, int dimension);

/// Values of all basis functions at u, [m].
std::vector<double> values_at(const AxisBasis& basis, double u_m);

/// Gauss-Legendre nodes on the pieces of U on which filter and basis functions are polynomials.
/// Three nodes a piece integrate the product of three polynomials of degree <= 5 together exactly.
struct AxisNodes {
    std::vector<double> u_m;
    std::vector<double> weight_m;  // times the filter's transmission
};
AxisNodes axis_nodes(const AxisBasis& basis, const AxisFilter& filter);

/// Integrals of filter times basis function, [m], metres.
std::vector<double> axis_integrals(const AxisBasis& basis, const AxisNodes& nodes);

}  // namespace nearfield::fit
