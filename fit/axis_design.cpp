// SPDX-License-Identifier: Apache-2.0
#include "fit/axis_design.h"

#include "formats/model/profile.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::fit {
namespace {

// Pieces shorter than this part of the pitch come from rounding of borders that coincide.
constexpr double kLeastPiece = 1e-12;

const std::array<double, 3> kNode = {-std::sqrt(0.6), 0.0, std::sqrt(0.6)};
constexpr std::array<double, 3> kWeight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

std::vector<double> borders(const AxisBasis& basis, const AxisFilter& filter) {
    const auto filter_cells = static_cast<int>(filter.profile->cells.size());
    const auto basis_cells = static_cast<int>(basis.profile->cells.size());
    const double half_m = 0.5 * filter_cells * filter.pitch_m;
    std::vector<double> all_m;
    for (int c = 0; c <= filter_cells; ++c)
        all_m.push_back(filter.center_m - half_m + c * filter.pitch_m);
    for (int q = 0; q < basis.count + basis_cells; ++q) {
        const double at_m = basis.first_center_m + (q - 0.5 * basis_cells) * basis.pitch_m;
        if (at_m > filter.center_m - half_m && at_m < filter.center_m + half_m)
            all_m.push_back(at_m);
    }
    std::sort(all_m.begin(), all_m.end());
    return all_m;
}

}  // namespace

AxisBasis axis_basis(const Slab& planes, int dimension) {
    return {&planes.profile, planes.grid[dimension], planes.pitch_m[dimension],
            planes.basis_center_m(0, 0)[dimension]};
}

std::vector<double> values_at(const AxisBasis& basis, double u_m) {
    std::vector<double> values(static_cast<std::size_t>(basis.count));
    for (int m = 0; m < basis.count; ++m)
        values[static_cast<std::size_t>(m)] =
            model::eval(*basis.profile, (u_m - basis.first_center_m) / basis.pitch_m - m);
    return values;
}

AxisNodes axis_nodes(const AxisBasis& basis, const AxisFilter& filter) {
    const std::vector<double> borders_m = borders(basis, filter);
    AxisNodes nodes;
    for (std::size_t p = 0; p + 1 < borders_m.size(); ++p) {
        const double length_m = borders_m[p + 1] - borders_m[p];
        if (length_m <= kLeastPiece * basis.pitch_m)
            continue;
        for (std::size_t g = 0; g < kNode.size(); ++g) {
            const double u_m = borders_m[p] + 0.5 * length_m * (1.0 + kNode[g]);
            const double passed =
                model::eval(*filter.profile, (u_m - filter.center_m) / filter.pitch_m);
            nodes.u_m.push_back(u_m);
            nodes.weight_m.push_back(kWeight[g] * length_m * passed);
        }
    }
    return nodes;
}

std::vector<double> axis_integrals(const AxisBasis& basis, const AxisNodes& nodes) {
    std::vector<double> sums(static_cast<std::size_t>(basis.count), 0.0);
    for (std::size_t g = 0; g < nodes.u_m.size(); ++g) {
        const std::vector<double> values = values_at(basis, nodes.u_m[g]);
        for (std::size_t m = 0; m < sums.size(); ++m)
            sums[m] += nodes.weight_m[g] * values[m];
    }
    return sums;
}

}  // namespace nearfield::fit
