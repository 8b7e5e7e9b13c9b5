// SPDX-License-Identifier: Apache-2.0
#include "sample_data/basis_solve.h"

#include "formats/model/profile.h"
#include "sample_data/aperture.h"

#include <algorithm>
#include <cmath>

namespace nearfield::sample_data {
namespace {

// Projected over-relaxation: stops when no coefficient moves by more than this part of the row's
// largest.
constexpr double kSolveTolerance = 1e-7;
constexpr int kMaxSweeps = 400;
constexpr double kOverRelaxation = 1.4;

// Inverse of a symmetric positive definite matrix by Gauss-Jordan elimination without pivots.
std::vector<double> inverse_of(std::vector<double> a, int n) {
    const auto at = [n](int row, int column) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(n) +
               static_cast<std::size_t>(column);
    };
    std::vector<double> inverse(a.size(), 0.0);
    for (int k = 0; k < n; ++k) {
        inverse[at(k, k)] = 1.0;
    }
    for (int k = 0; k < n; ++k) {
        const double pivot = 1.0 / a[at(k, k)];
        for (int column = 0; column < n; ++column) {
            a[at(k, column)] *= pivot;
            inverse[at(k, column)] *= pivot;
        }
        for (int row = 0; row < n; ++row) {
            const double factor = row == k ? 0.0 : a[at(row, k)];
            for (int column = 0; column < n; ++column) {
                a[at(row, column)] -= factor * a[at(k, column)];
                inverse[at(row, column)] -= factor * inverse[at(k, column)];
            }
        }
    }
    return inverse;
}

void add_scaled(double* to, const double* from, double factor, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        to[i] += factor * from[i];
    }
}

// The two axes and the number of texels in the row.
struct Row {
    const Axis& x;
    const Axis& y;
    std::size_t width;

    std::size_t offset(int column, int row) const {
        return static_cast<std::size_t>(row * x.count + column) * width;
    }
};

// c = (Gy (x) Gx)^-1 b: the inverse of a Kronecker product is that of its factors, one axis after
// the other.
std::vector<double> unconstrained(const Row& row, std::span<const double> b) {
    std::vector<double> half(b.size(), 0.0), c(b.size(), 0.0);
    for (int y = 0; y < row.y.count; ++y) {
        for (int x = 0; x < row.x.count; ++x) {
            for (int k = 0; k < row.x.count; ++k) {
                const double factor = row.x.inverse[row.x.at(x, k)];
                add_scaled(&half[row.offset(x, y)], &b[row.offset(k, y)], factor, row.width);
            }
        }
    }
    for (int y = 0; y < row.y.count; ++y) {
        for (int k = 0; k < row.y.count; ++k) {
            const double factor = row.y.inverse[row.y.at(y, k)];
            add_scaled(&c[row.offset(0, y)], &half[row.offset(0, k)], factor,
                       row.width * static_cast<std::size_t>(row.x.count));
        }
    }
    return c;
}

// One coefficient of all texels: c <- max(0, c + omega (b - G c)_m / G_mm). Returns the largest
// change.
double relax_one(const Row& row,
                 std::span<const double> b,
                 int x,
                 int y,
                 std::vector<double>& residual,
                 std::vector<double>& c) {
    const auto gram = [](const Axis& axis, int k, int m) { return axis.gram[axis.at(k, m)]; };
    const std::size_t here = row.offset(x, y);
    std::copy_n(&b[here], row.width, residual.begin());
    const int reach = static_cast<int>(row.x.profile.cells.size()) - 1;
    for (int v = std::max(0, y - reach); v <= std::min(row.y.count - 1, y + reach); ++v) {
        for (int u = std::max(0, x - reach); u <= std::min(row.x.count - 1, x + reach); ++u) {
            add_scaled(residual.data(), &c[row.offset(u, v)],
                       -gram(row.x, x, u) * gram(row.y, y, v), row.width);
        }
    }
    const double step = kOverRelaxation / (gram(row.x, x, x) * gram(row.y, y, y));
    double change = 0.0;
    for (std::size_t i = 0; i < row.width; ++i) {
        const double moved = std::max(0.0, c[here + i] + step * residual[i]);
        change = std::max(change, std::abs(moved - c[here + i]));
        c[here + i] = moved;
    }
    return change;
}

// Projected successive over-relaxation: converges to the non-negative least-squares solution since
// G is positive definite (Cryer, "The solution of a quadratic programming problem using systematic
// overrelaxation", 1971).
void relax(const Row& row, std::span<const double> b, std::vector<double>& c) {
    std::vector<double> residual(row.width);
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
        double change = 0.0;
        for (int y = 0; y < row.y.count; ++y) {
            for (int x = 0; x < row.x.count; ++x) {
                change = std::max(change, relax_one(row, b, x, y, residual, c));
            }
        }
        if (change <= kSolveTolerance * *std::max_element(c.begin(), c.end())) {
            return;
        }
    }
}

}  // namespace

double Axis::value(int k, double u_m) const {
    return model::eval(profile, (u_m - first_center_m) / pitch_m - k);
}

std::vector<double> Axis::cell_edges_m() const {
    const int cells = static_cast<int>(profile.cells.size());
    std::vector<double> edges;
    edges.reserve(static_cast<std::size_t>(count + cells));
    for (int k = 0; k < count + cells; ++k) {
        edges.push_back(first_center_m + (k - 0.5 * cells) * pitch_m);
    }
    return edges;
}

Axis make_axis(const Slab& planes, int dimension) {
    Axis axis;
    axis.profile = planes.profile;
    axis.count = planes.grid[dimension];
    axis.pitch_m = planes.pitch_m[dimension];
    axis.first_center_m = planes.basis_center_m(0, 0)[dimension];
    axis.integral_m = model::integral(planes.profile) * axis.pitch_m;
    const std::size_t n = static_cast<std::size_t>(axis.count);
    axis.gram.assign(n * n, 0.0);
    const std::vector<double> edges = axis.cell_edges_m();
    // Products of profiles are polynomials of degree <= 4 on each cell: three nodes are exact.
    for (const Node& node : gauss_nodes(edges.front(), edges.back(), edges, axis.pitch_m)) {
        for (int k = 0; k < axis.count; ++k) {
            for (int m = 0; m < axis.count; ++m) {
                axis.gram[axis.at(k, m)] +=
                    node.weight_m * axis.value(k, node.at_m) * axis.value(m, node.at_m);
            }
        }
    }
    axis.inverse = inverse_of(axis.gram, axis.count);
    return axis;
}

std::vector<Term> terms_at(const Axis& axis, double u_m) {
    std::vector<Term> terms;
    for (int k = 0; k < axis.count; ++k) {
        const double value = axis.value(k, u_m);
        if (value != 0.0) {
            terms.push_back({k, value});
        }
    }
    return terms;
}

RowSolution solve_row(const Axis& axis_x,
                      const Axis& axis_y,
                      std::span<const double> b,
                      std::span<const double> integral) {
    RowSolution row;
    const Row shape{axis_x, axis_y, integral.size()};
    row.coeffs = unconstrained(shape, b);
    const double function_m2 = axis_x.integral_m * axis_y.integral_m;
    double negative = 0.0;
    for (double& c : row.coeffs) {
        negative -= std::min(c, 0.0);
        c = std::max(c, 0.0);
    }
    row.negative_m2 = negative * function_m2;
    if (negative > 0.0) {
        relax(shape, b, row.coeffs);
    }
    for (std::size_t i = 0; i < shape.width; ++i) {
        double sum = 0.0;
        for (std::size_t k = i; k < row.coeffs.size(); k += shape.width) {
            sum += row.coeffs[k];
        }
        const double held = sum * function_m2;
        row.rescaled_m2 += std::abs(integral[i] - held);
        const double factor = held > 0.0 ? integral[i] / held : 0.0;
        for (std::size_t k = i; k < row.coeffs.size(); k += shape.width) {
            row.coeffs[k] *= factor;
        }
    }
    return row;
}

}  // namespace nearfield::sample_data
