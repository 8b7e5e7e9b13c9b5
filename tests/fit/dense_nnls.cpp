// SPDX-License-Identifier: Apache-2.0
#include "tests/fit/dense_nnls.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::fit {
namespace {

// A and b after all orthogonal transformations so far: rows 0 ... of the columns in `used` are
// upper triangular.
struct Triangle {
    Eigen::MatrixXd a;
    Eigen::VectorXd b;
    std::vector<int> used;
};

// Brings column j in by the reflection that clears it below its new diagonal entry.
void add_column(Triangle& triangle, int j) {
    const auto top = static_cast<Eigen::Index>(triangle.used.size());
    const Eigen::Index rows = triangle.a.rows() - top;
    Eigen::VectorXd essential(rows - 1);
    double tau = 0, beta = 0;
    triangle.a.col(j).tail(rows).makeHouseholder(essential, tau, beta);
    Eigen::VectorXd room(triangle.a.cols());
    triangle.a.bottomRows(rows).applyHouseholderOnTheLeft(essential, tau, room.data());
    triangle.b.tail(rows).applyHouseholderOnTheLeft(essential, tau, room.data());
    triangle.used.push_back(j);
}

void drop_column(Triangle& triangle, std::size_t place) {
    triangle.used.erase(triangle.used.begin() + static_cast<std::ptrdiff_t>(place));
    for (std::size_t p = place; p < triangle.used.size(); ++p) {
        const auto row = static_cast<Eigen::Index>(p);
        Eigen::JacobiRotation<double> rotation;
        rotation.makeGivens(triangle.a(row, triangle.used[p]),
                            triangle.a(row + 1, triangle.used[p]));
        triangle.a.applyOnTheLeft(row, row + 1, rotation.adjoint());
        triangle.b.applyOnTheLeft(row, row + 1, rotation.adjoint());
    }
}

Eigen::VectorXd solution(const Triangle& triangle) {
    const auto count = static_cast<Eigen::Index>(triangle.used.size());
    Eigen::VectorXd x = triangle.b.head(count);
    for (Eigen::Index p = count - 1; p >= 0; --p) {
        const int column = triangle.used[static_cast<std::size_t>(p)];
        x(p) /= triangle.a(p, column);
        x.head(p) -= x(p) * triangle.a.col(column).head(p);
    }
    return x;
}

// Moves x towards the triangle's solution as far as it stays >= 0; drops what has become 0.
void move_and_drop(Triangle& triangle, const Eigen::VectorXd& target, Eigen::VectorXd& x) {
    double share = 1.0;
    for (std::size_t p = 0; p < triangle.used.size(); ++p) {
        const double from = x(triangle.used[p]), to = target(static_cast<Eigen::Index>(p));
        if (to <= 0.0)
            share = std::min(share, from / (from - to));
    }
    for (std::size_t p = triangle.used.size(); p-- > 0;) {
        const int column = triangle.used[p];
        const double to = target(static_cast<Eigen::Index>(p));
        x(column) += share * (to - x(column));
        if (to <= 0.0 && x(column) <= 1e-14 * std::abs(to)) {
            x(column) = 0.0;
            drop_column(triangle, p);
        }
    }
}

}  // namespace

std::vector<double> dense_nnls(std::span<const double> a, std::span<const double> b, int columns) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = static_cast<Eigen::Index>(b.size());
    Triangle triangle{Eigen::Map<const RowMajor>(a.data(), rows, columns),
                      Eigen::Map<const Eigen::VectorXd>(b.data(), rows),
                      {}};
    Eigen::VectorXd x = Eigen::VectorXd::Zero(columns);
    const Eigen::VectorXd norms = triangle.a.colwise().norm();
    const double tolerance = 1e-13 * triangle.b.norm();
    for (int step = 0; step < 10 * columns; ++step) {
        const auto top = static_cast<Eigen::Index>(triangle.used.size());
        if (top == rows)
            break;
        Eigen::VectorXd descent =
            triangle.a.bottomRows(rows - top).transpose() * triangle.b.tail(rows - top);
        for (const int column : triangle.used)
            descent(column) = 0.0;
        for (Eigen::Index j = 0; j < columns; ++j)
            descent(j) = norms(j) > 0.0 ? descent(j) / norms(j) : 0.0;
        Eigen::Index best = 0;
        if (!(descent.maxCoeff(&best) > tolerance))
            break;
        add_column(triangle, static_cast<int>(best));
        Eigen::VectorXd target = solution(triangle);
        while (!triangle.used.empty() && target.minCoeff() <= 0.0) {
            move_and_drop(triangle, target, x);
            target = solution(triangle);
        }
        for (std::size_t p = 0; p < triangle.used.size(); ++p)
            x(triangle.used[p]) = target(static_cast<Eigen::Index>(p));
    }
    return {x.data(), x.data() + columns};
}

}  // namespace nearfield::fit
