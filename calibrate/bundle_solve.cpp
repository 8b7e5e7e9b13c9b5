// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bundle.h"
#include "calibrate/bundle_problem.h"

#include <Eigen/Dense>

#include <algorithm>
#include <limits>
#include <utility>

namespace nearfield::calibrate {
namespace {

// What all views share, in SharedLayout's order.
std::vector<double*> shared_blocks(Bundle& bundle) {
    std::vector<double*> blocks = {bundle.lens.data(), bundle.bend_m.data()};
    if (bundle.has_planes) {
        blocks.push_back(bundle.s.numbers.data());
        blocks.push_back(bundle.u.numbers.data());
        blocks.push_back(bundle.stage.numbers.data());
    }
    return blocks;
}

// Columns: what a step of each estimated number does to a block's numbers.
Eigen::MatrixXd tangents_of(const ceres::Problem& problem, double* block) {
    const int size = problem.ParameterBlockSize(block);
    if (problem.IsParameterBlockConstant(block))
        return Eigen::MatrixXd::Zero(size, 0);
    const ceres::Manifold* manifold = problem.GetManifold(block);
    if (manifold == nullptr)
        return Eigen::MatrixXd::Identity(size, size);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    RowMajor jacobian(size, manifold->TangentSize());
    manifold->PlusJacobian(block, jacobian.data());
    return jacobian;
}

// The estimated numbers: shared ones first, then each board's.
struct Columns {
    int shared = 0;
    std::vector<int> board_begin;  // and the end of the last
};

// Rows of one board (or of none): [shared | its pose].
Eigen::MatrixXd rows_of(const ceres::CRSMatrix& jacobian,
                        const std::vector<int>& rows,
                        int shared,
                        int pose_begin,
                        int pose_count) {
    Eigen::MatrixXd dense =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), pose_count + shared);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto row = static_cast<std::size_t>(rows[i]);
        for (int at = jacobian.rows[row]; at < jacobian.rows[row + 1]; ++at) {
            const int column = jacobian.cols[static_cast<std::size_t>(at)];
            const int to = column < shared ? pose_count + column : column - pose_begin;
            dense(static_cast<Eigen::Index>(i), to) = jacobian.values[static_cast<std::size_t>(at)];
        }
    }
    return dense;
}

// The triangle R of J = Q R.
Eigen::MatrixXd triangle_of(const Eigen::MatrixXd& rows) {
    const Eigen::HouseholderQR<Eigen::MatrixXd> factors(rows);
    const Eigen::Index count = std::min(rows.rows(), rows.cols());
    return factors.matrixQR().topRows(count).triangularView<Eigen::Upper>();
}

// Rows of the Jacobian by the board whose pose they depend on; the last: none.
std::vector<std::vector<int>> rows_by_board(const ceres::CRSMatrix& jacobian,
                                            const Columns& columns) {
    const std::size_t boards = columns.board_begin.size() - 1;
    std::vector<std::vector<int>> rows(boards + 1);
    for (int row = 0; row < jacobian.num_rows; ++row) {
        const auto end = static_cast<std::size_t>(jacobian.rows[static_cast<std::size_t>(row) + 1]);
        const int last = jacobian.cols[end - 1];
        const auto next =
            std::upper_bound(columns.board_begin.begin(), columns.board_begin.end(), last);
        const auto board = static_cast<std::size_t>(next - columns.board_begin.begin());
        rows[board == 0 ? boards : board - 1].push_back(row);
    }
    return rows;
}

// The Jacobian once each board's pose is eliminated: orthogonally, so that no digits are lost to
// squares.
struct Eliminated {
    Eigen::MatrixXd shared;              // what is left: of the shared numbers alone
    std::vector<Eigen::MatrixXd> poses;  // [board]: rows [triangle of its pose | shared]
};

Eliminated eliminate_poses(const ceres::CRSMatrix& jacobian, const Columns& columns) {
    const std::vector<std::vector<int>> rows = rows_by_board(jacobian, columns);
    const std::size_t boards = rows.size() - 1;
    Eliminated eliminated{Eigen::MatrixXd(0, columns.shared), {}};
    for (std::size_t board = 0; board <= boards; ++board) {
        const int begin = board < boards ? columns.board_begin[board] : columns.shared;
        const int pose = board < boards ? columns.board_begin[board + 1] - begin : 0;
        const Eigen::MatrixXd dense = rows_of(jacobian, rows[board], columns.shared, begin, pose);
        const Eigen::MatrixXd triangle = dense.rows() > 0 ? triangle_of(dense) : dense;
        const Eigen::Index top = std::min<Eigen::Index>(pose, triangle.rows());
        const Eigen::Index left = triangle.rows() - top;
        if (board < boards)
            eliminated.poses.emplace_back(triangle.topRows(top));
        if (left == 0)
            continue;
        Eigen::MatrixXd longer(eliminated.shared.rows() + left, columns.shared);
        longer << eliminated.shared, triangle.bottomRightCorner(left, columns.shared);
        eliminated.shared = triangle_of(longer);
    }
    return eliminated;
}

// A pose follows the shared numbers, and has noise of its own.
Eigen::MatrixXd pose_covariance(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& shared) {
    const Eigen::Index pose = rows.cols() - shared.cols();
    if (rows.rows() < pose)
        return Eigen::MatrixXd::Constant(pose, pose, std::numeric_limits<double>::infinity());
    const auto triangle = rows.leftCols(pose).triangularView<Eigen::Upper>();
    const Eigen::MatrixXd own = triangle.solve(Eigen::MatrixXd::Identity(pose, pose));
    const Eigen::MatrixXd follows = triangle.solve(Eigen::MatrixXd(rows.rightCols(shared.cols())));
    return own * own.transpose() + follows * shared * follows.transpose();
}

// (J^T J)^-1; none where J's columns are dependent to rounding.
std::optional<Eigen::MatrixXd> inverse_square(const Eigen::MatrixXd& rows) {
    const Eigen::VectorXd size = rows.colwise().norm();
    if (rows.rows() < rows.cols() || !(size.minCoeff() > 0.0))
        return std::nullopt;
    const Eigen::VectorXd scale = size.cwiseInverse();
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(rows * scale.asDiagonal());
    constexpr double kDependent = 1e-12;
    const Eigen::VectorXd diagonal = factors.matrixQR().diagonal().cwiseAbs();
    if (!(diagonal.minCoeff() > kDependent * diagonal.maxCoeff()))
        return std::nullopt;
    const Eigen::Index count = rows.cols();
    const Eigen::MatrixXd inverse_triangle =
        factors.matrixQR().topRows(count).triangularView<Eigen::Upper>().solve(
            Eigen::MatrixXd::Identity(count, count));
    const Eigen::MatrixXd root =
        scale.asDiagonal() * (factors.colsPermutation() * inverse_triangle);
    return Eigen::MatrixXd(root * root.transpose());
}

}  // namespace

int solve(Bundle& bundle,
          const Observations& observations,
          const Weights& weights,
          const Choice& choice) {
    const BundleProblem made = make_problem(bundle, observations, weights, choice);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (double* board : made.boards)
        options.linear_solver_ordering->AddElementToGroup(board, 0);
    for (double* block : shared_blocks(bundle))
        options.linear_solver_ordering->AddElementToGroup(block, 1);
    options.num_threads = 1;  // sums in one order: the same bits on every machine's threads
    options.max_num_iterations = 200;
    options.function_tolerance = choice.tolerance;
    options.parameter_tolerance = 1e-14;
    options.gradient_tolerance = 1e-16;
    // Where numbers are nearly interchangeable, as a rational lens' are, no damping at all leaves a
    // matrix that has no factors.
    options.max_trust_region_radius = 1e12;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, made.problem.get(), &summary);
    return static_cast<int>(summary.iterations.size());
}

std::optional<SharedCovariance> shared_covariance(Bundle& bundle,
                                                  const Observations& observations,
                                                  const Weights& weights,
                                                  const Choice& choice) {
    const BundleProblem made = make_problem(bundle, observations, weights, choice);
    const std::vector<double*> shared = shared_blocks(bundle);
    ceres::Problem::EvaluateOptions options;
    options.apply_loss_function = false;
    std::vector<Eigen::MatrixXd> tangents;
    int estimated = 0, ambient = 0;
    for (double* block : shared) {
        tangents.push_back(tangents_of(*made.problem, block));
        estimated += static_cast<int>(tangents.back().cols());
        ambient += static_cast<int>(tangents.back().rows());
        if (tangents.back().cols() > 0)
            options.parameter_blocks.push_back(block);
    }
    options.parameter_blocks.insert(options.parameter_blocks.end(), made.boards.begin(),
                                    made.boards.end());
    ceres::CRSMatrix jacobian;
    if (!made.problem->Evaluate(options, nullptr, nullptr, nullptr, &jacobian))
        return std::nullopt;
    Columns columns{estimated, {estimated}};
    for (const double* board : made.boards)
        columns.board_begin.push_back(columns.board_begin.back() +
                                      made.problem->ParameterBlockSize(board));
    const Eliminated eliminated = eliminate_poses(jacobian, columns);
    const auto inverse = inverse_square(eliminated.shared);
    if (!inverse)
        return std::nullopt;
    std::vector<Eigen::MatrixXd> poses(bundle.boards.size());
    for (std::size_t board = 0; board < made.boards.size(); ++board)
        poses[made.views[board]] = pose_covariance(eliminated.poses[board], *inverse);
    Eigen::MatrixXd expand = Eigen::MatrixXd::Zero(ambient, estimated);
    Eigen::Index row = 0, column = 0;
    for (const Eigen::MatrixXd& part : tangents) {
        expand.block(row, column, part.rows(), part.cols()) = part;
        row += part.rows();
        column += part.cols();
    }
    return SharedCovariance{expand * *inverse * expand.transpose(), std::move(poses)};
}

}  // namespace nearfield::calibrate
