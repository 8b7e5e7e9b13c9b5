// SPDX-License-Identifier: Apache-2.0
#include "fit/quality.h"

#include "formats/files/error.h"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

// Squares and sums of what was foretold against what is true.
struct Comparison {
    double square_off = 0, square = 0, sum_off = 0, sum = 0;
};

// Measurements of `design` from a tile's coefficients, against `truth`.
Comparison compare(const Design& design,
                   const TileResult& fitted,
                   int channels,
                   const TileInput& truth) {
    const auto width = static_cast<std::size_t>(design.texels.x);
    const auto height = static_cast<std::size_t>(fitted.rows.row_count);
    const auto count = static_cast<std::size_t>(design.measurement_count);
    const auto n = static_cast<std::size_t>(design.basis_count());
    Comparison comparison;
    TexelDesign texel;
    std::vector<double> coeffs(n);
    for (std::size_t row = 0; row < height; ++row)
        for (std::size_t i = 0; i < width; ++i) {
            fill_texel_design(design, static_cast<int>(i),
                              fitted.rows.first_row + static_cast<int>(row), texel);
            for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
                for (std::size_t m = 0; m < n; ++m)
                    coeffs[m] = static_cast<double>(
                        fitted.coeffs[((c * n + m) * height + row) * width + i]);
                for (std::size_t k = 0; k < count; ++k) {
                    const double value = static_cast<double>(
                        truth.value[((c * count + k) * height + row) * width + i]);
                    const double off = predicted(texel, static_cast<int>(k), coeffs) - value;
                    comparison.square_off += off * off;
                    comparison.square += value * value;
                    comparison.sum_off += off;
                    comparison.sum += value;
                }
            }
        }
    return comparison;
}

double rms_rel(const Comparison& comparison) {
    return comparison.square > 0.0 ? std::sqrt(comparison.square_off / comparison.square) : 0.0;
}

}  // namespace

Conditioning conditioning(const TexelDesign& texel, std::span<const double> weight) {
    const int n = texel.grid.x * texel.grid.y;
    const std::vector<double> g = dense(texel);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const RowMajor> matrix(g.data(), texel.measurement_count, n);
    const Eigen::Map<const Eigen::VectorXd> weights(weight.data(), texel.measurement_count);
    Eigen::MatrixXd normal = matrix.transpose() * weights.asDiagonal() * matrix;
    Conditioning result;
    Eigen::VectorXd scale(n);
    for (Eigen::Index m = 0; m < n; ++m) {
        result.unseen_count += normal(m, m) > 0.0 ? 0 : 1;
        scale(m) = normal(m, m) > 0.0 ? 1.0 / std::sqrt(normal(m, m)) : 0.0;
    }
    normal = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(normal, Eigen::EigenvaluesOnly);
    result.least = std::max(0.0, solver.eigenvalues().minCoeff());
    result.most = solver.eigenvalues().maxCoeff();
    // Below rounding of the eigenvalues themselves.
    const double rounding = n * std::numeric_limits<double>::epsilon() * result.most;
    result.condition = result.least > rounding ? result.most / result.least
                                               : std::numeric_limits<double>::infinity();
    return result;
}

RepresentationError representation_error(const Design& design,
                                         const FitOptions& options,
                                         TileRange rows,
                                         const TileInput& truth,
                                         const Design& check_design,
                                         const TileInput& check) {
    const std::size_t wanted = static_cast<std::size_t>(options.channels) *
                               static_cast<std::size_t>(check_design.measurement_count) *
                               static_cast<std::size_t>(rows.row_count) *
                               static_cast<std::size_t>(check_design.texels.x);
    if (check.value.size() != wanted || check_design.grid != design.grid ||
        check_design.texels != design.texels)
        throw Error{"bad tile", "representation error", fmt::format("{} values to check", wanted),
                    fmt::format("{}", check.value.size())};
    FitReport report;
    const TileResult fitted = solve_tile(design, options, rows, truth, report);
    RepresentationError error;
    error.data_rms_rel = rms_rel(compare(design, fitted, options.channels, truth));
    const Comparison checked = compare(check_design, fitted, options.channels, check);
    error.check_rms_rel = rms_rel(checked);
    error.check_bias_rel = checked.sum != 0.0 ? checked.sum_off / checked.sum : 0.0;
    return error;
}

}  // namespace nearfield::fit
