// SPDX-License-Identifier: Apache-2.0
/// The oracle's pieces of U: cut along cells and along texels' edges seen from a receiver, so that
/// what is integrated over each is smooth.
#pragma once

#include "formats/files/lightfield.h"
#include "tests/support/quadrature.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace nearfield::support {

/// Point on S as a function of the point on U, on one axis: s = slope * u + offset_m.
struct AxisMap {
    double slope = 1.0, offset_m = 0.0;

    double s_m(double u_m) const { return slope * u_m + offset_m; }
    double u_m(double s_m) const { return (s_m - offset_m) / slope; }
};

/// One axis of a slab.
struct Axis {
    int basis_count = 0, texel_count = 0;
    double first_center_m = 0, pitch_m = 0, s_min_m = 0, texel_m = 0;
    const Profile* profile = nullptr;

    int profile_cells() const { return static_cast<int>(profile->cells.size()); }
    int cell_count() const { return basis_count + profile_cells() - 1; }
    /// Lower edge on U of cell k, k = 0 ... cell_count.
    double edge_m(int k) const { return first_center_m + (k - 0.5 * profile_cells()) * pitch_m; }
    int texel_at(double s_m) const {
        return static_cast<int>(
            std::clamp(std::floor((s_m - s_min_m) / texel_m), -1.0, 1.0 * texel_count));
    }
    /// The basis function on its polynomial for cell k, 0 where its support leaves the cell out.
    double phi(int basis, int k, double u_m) const {
        const int part = k - basis;
        if (basis < 0 || basis >= basis_count || part < 0 || part >= profile_cells())
            return 0.0;
        const double x = (u_m - (first_center_m + basis * pitch_m)) / pitch_m;
        const auto& a = profile->cells[static_cast<std::size_t>(part)];
        return a[0] + a[1] * x + a[2] * x * x;
    }
};

Axis axis_of(const Slab& slab, int d);

/// An interval of U within one cell and one texel, with its quadrature nodes.
struct Piece {
    double low_m = 0, high_m = 0;
    int cell = 0, texel = 0;
    std::vector<double> u_m, weight_m;
    std::vector<double> phi;  // [basis within the cell: cell - n + 1 ... cell][node]
};

/// Where pieces must be short: length <= half the distance to (center_m, height_m). Infinite
/// height: anywhere.
struct Refinement {
    double center_m = 0, height_m = INFINITY;
};

/// Cuts U's aperture along cells and along the texels' edges; leaves out what does not reach S's
/// rectangle.
std::vector<Piece> cut_axis(const Axis& axis,
                            const AxisMap& map,
                            const Refinement& refinement,
                            const GaussRule& rule);

}  // namespace nearfield::support
