// SPDX-License-Identifier: Apache-2.0
#include "fit/lawson_hanson.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::fit {
namespace {

// A and b after all orthogonal transformations so far: rows 0 ... of the columns in `used` are
// upper triangular.
struct UpdatedQr {
    Eigen::MatrixXd a;
    Eigen::VectorXd b;
    std::vector<int> used;

    // Brings column j in by the reflection that clears it below its new diagonal entry.
    void add(int j) {
        const auto top = static_cast<Eigen::Index>(used.size());
        const Eigen::Index rows = a.rows() - top;
        Eigen::VectorXd essential(rows - 1);
        double tau = 0, beta = 0;
        a.col(j).tail(rows).makeHouseholder(essential, tau, beta);
        Eigen::VectorXd room(a.cols());
        a.bottomRows(rows).applyHouseholderOnTheLeft(essential, tau, room.data());
        b.tail(rows).applyHouseholderOnTheLeft(essential, tau, room.data());
        used.push_back(j);
    }

    void drop(std::size_t place) {
        used.erase(used.begin() + static_cast<std::ptrdiff_t>(place));
        for (std::size_t p = place; p < used.size(); ++p) {
            const auto row = static_cast<Eigen::Index>(p);
            Eigen::JacobiRotation<double> rotation;
            rotation.makeGivens(a(row, used[p]), a(row + 1, used[p]));
            a.applyOnTheLeft(row, row + 1, rotation.adjoint());
            b.applyOnTheLeft(row, row + 1, rotation.adjoint());
        }
    }

    Eigen::VectorXd solution() const {
        const auto count = static_cast<Eigen::Index>(used.size());
        Eigen::VectorXd x = b.head(count);
        for (Eigen::Index p = count - 1; p >= 0; --p) {
            const int column = used[static_cast<std::size_t>(p)];
            x(p) /= a(p, column);
            x.head(p) -= x(p) * a.col(column).head(p);
        }
        return x;
    }

    // A^T (b - A x) for the x of solution(), put into its place among all columns.
    Eigen::VectorXd descent(const Eigen::VectorXd& /*x*/) const {
        const Eigen::Index rest = a.rows() - static_cast<Eigen::Index>(used.size());
        return a.bottomRows(rest).transpose() * b.tail(rest);
    }
};

// A and b as they are; every solution factorizes the columns in `used` again.
struct FreshQr {
    Eigen::MatrixXd a;
    Eigen::VectorXd b;
    std::vector<int> used;

    void add(int j) { used.push_back(j); }
    void drop(std::size_t place) { used.erase(used.begin() + static_cast<std::ptrdiff_t>(place)); }

    Eigen::VectorXd solution() const {
        if (used.empty())
            return {};
        Eigen::MatrixXd columns(a.rows(), static_cast<Eigen::Index>(used.size()));
        for (std::size_t p = 0; p < used.size(); ++p)
            columns.col(static_cast<Eigen::Index>(p)) = a.col(used[p]);
        return Eigen::HouseholderQR<Eigen::MatrixXd>(columns).solve(b);
    }

    Eigen::VectorXd descent(const Eigen::VectorXd& x) const { return a.transpose() * (b - a * x); }
};

// Moves x towards the target as far as it stays >= 0; drops what has become 0.
template <typename Qr>
void move_and_drop(Qr& qr, const Eigen::VectorXd& target, Eigen::VectorXd& x) {
    double share = 1.0;
    for (std::size_t p = 0; p < qr.used.size(); ++p) {
        const double from = x(qr.used[p]), to = target(static_cast<Eigen::Index>(p));
        if (to <= 0.0)
            share = std::min(share, from / (from - to));
    }
    for (std::size_t p = qr.used.size(); p-- > 0;) {
        const int column = qr.used[p];
        const double to = target(static_cast<Eigen::Index>(p));
        x(column) += share * (to - x(column));
        if (to <= 0.0 && x(column) <= 1e-14 * std::abs(to)) {
            x(column) = 0.0;
            qr.drop(p);
        }
    }
}

template <typename Qr>
std::vector<double> minimize(Qr qr) {
    const Eigen::Index columns = qr.a.cols();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(columns);
    const Eigen::VectorXd norms = qr.a.colwise().norm();
    // As a cosine: above the rounding of a gradient that is computed anew at every exchange.
    const double tolerance = 1e-12 * qr.b.norm();
    for (Eigen::Index step = 0; step < 10 * columns; ++step) {
        if (static_cast<Eigen::Index>(qr.used.size()) == qr.a.rows())
            break;
        Eigen::VectorXd descent = qr.descent(x);
        for (const int column : qr.used)
            descent(column) = 0.0;
        for (Eigen::Index j = 0; j < columns; ++j)
            descent(j) = norms(j) > 0.0 ? descent(j) / norms(j) : 0.0;
        Eigen::Index best = 0;
        if (!(descent.maxCoeff(&best) > tolerance))
            break;
        qr.add(static_cast<int>(best));
        Eigen::VectorXd target = qr.solution();
        while (!qr.used.empty() && target.minCoeff() <= 0.0) {
            move_and_drop(qr, target, x);
            target = qr.solution();
        }
        for (std::size_t p = 0; p < qr.used.size(); ++p)
            x(qr.used[p]) = target(static_cast<Eigen::Index>(p));
    }
    return {x.data(), x.data() + columns};
}

}  // namespace

std::vector<double> lawson_hanson(std::span<const double> a,
                                  std::span<const double> b,
                                  int columns,
                                  LeastSquares kept) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = static_cast<Eigen::Index>(b.size());
    const Eigen::MatrixXd matrix = Eigen::Map<const RowMajor>(a.data(), rows, columns);
    const Eigen::VectorXd data = Eigen::Map<const Eigen::VectorXd>(b.data(), rows);
    if (kept == LeastSquares::Fresh)
        return minimize(FreshQr{matrix, data, {}});
    return minimize(UpdatedQr{matrix, data, {}});
}

}  // namespace nearfield::fit
