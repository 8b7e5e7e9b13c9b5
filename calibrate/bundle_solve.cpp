// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bundle.h"
#include "calibrate/bundle_residuals.h"

#include <Eigen/Cholesky>
#include <ceres/ceres.h>

#include <cmath>
#include <memory>
#include <vector>

namespace nearfield::calibrate {
namespace {

// fx and fy rise and fall together: one tangent for both, one for each other number.
class SquarePixels final : public ceres::Manifold {
  public:
    explicit SquarePixels(int size) : size_(size) {}

    int AmbientSize() const override { return size_; }
    int TangentSize() const override { return size_ - 1; }
    bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
        for (int i = 0; i < size_; ++i)
            x_plus_delta[i] = x[i] + delta[i == 0 ? 0 : i - 1];
        return true;
    }
    bool PlusJacobian(const double*, double* jacobian) const override {
        for (int i = 0; i < size_ * (size_ - 1); ++i)
            jacobian[i] = 0.0;
        for (int i = 0; i < size_; ++i)
            jacobian[i * (size_ - 1) + (i == 0 ? 0 : i - 1)] = 1.0;
        return true;
    }
    bool Minus(const double* y, const double* x, double* y_minus_x) const override {
        for (int i = 1; i < size_; ++i)
            y_minus_x[i - 1] = y[i] - x[i];
        return true;
    }
    bool MinusJacobian(const double*, double* jacobian) const override {
        for (int i = 0; i < size_ * (size_ - 1); ++i)
            jacobian[i] = 0.0;
        for (int i = 1; i < size_; ++i)
            jacobian[(i - 1) * size_ + i] = 1.0;
        return true;
    }

  private:
    int size_;
};

std::unique_ptr<ceres::LossFunction> loss_of(const Choice& choice) {
    switch (choice.loss) {
        case Loss::Huber:
            return std::make_unique<ceres::HuberLoss>(choice.loss_scale);
        case Loss::Cauchy:
            return std::make_unique<ceres::CauchyLoss>(choice.loss_scale);
        case Loss::Squares:
            break;
    }
    return nullptr;
}

// The problem over a bundle, which it points into.
struct BundleProblem {
    std::unique_ptr<ceres::LossFunction> loss;
    ceres::Problem problem;
    std::vector<double*> boards;  // that have residuals

    BundleProblem(const Choice& choice) : loss(loss_of(choice)), problem(options()) {}

    static ceres::Problem::Options options() {
        ceres::Problem::Options options;
        options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        options.disable_all_safety_checks = true;
        return options;
    }
};

template <rig::LensModel kModel>
void add_corner(
    Bundle& bundle, std::size_t view, const Corner& corner, double sigma_px, BundleProblem& to) {
    constexpr int kLens = lens_numbers(kModel);
    BoardPose& board = bundle.boards[view];
    double* lens = bundle.lens.data();
    double* bend = bundle.bend_m.data();
    const BoardPoint point = board_point(bundle, corner);
    if (board.plane == capture::TargetPlane::Free) {
        using Residual = FreeCornerResidual<kModel>;
        to.problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 2, kLens, 3, 6>(
                                        new Residual{point, corner.at_px, sigma_px}),
                                    to.loss.get(), lens, bend, board.numbers.data());
        return;
    }
    PlaneMove& plane = board.plane == capture::TargetPlane::Screen ? bundle.s : bundle.u;
    using Residual = PlacedCornerResidual<kModel>;
    to.problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Residual, 2, kLens, 3, 3, 3>(
            new Residual{point, corner.at_px, sigma_px, plane.camera_from_anchor}),
        to.loss.get(), lens, bend, plane.numbers.data(), board.numbers.data());
}

template <rig::LensModel kModel>
void add_residuals(Bundle& bundle,
                   const Observations& observations,
                   const Weights& weights,
                   BundleProblem& to) {
    for (std::size_t view = 0; view < observations.boards.size(); ++view) {
        const std::vector<Corner>& corners = observations.boards[view].corners;
        bool is_seen = false;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (weights.is_outlier[view][i] != 0)
                continue;
            add_corner<kModel>(bundle, view, corners[i], weights.corner_sigma_px, to);
            is_seen = true;
        }
        if (is_seen)
            to.boards.push_back(bundle.boards[view].numbers.data());
    }
    if (!bundle.has_planes)
        return;
    constexpr int kLens = lens_numbers(kModel);
    for (std::size_t i = 0; i < observations.filters.size(); ++i) {
        const FilterView& filter = observations.filters[i];
        using Residual = FilterResidual<kModel>;
        to.problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Residual, 2, kLens, 3, 6>(new Residual{
                glm::dvec2(filter.position) - bundle.stage.middle, bundle.stage.handedness,
                filter.center_px, weights.filter_whitening[i], bundle.u.camera_from_anchor}),
            nullptr, bundle.lens.data(), bundle.u.numbers.data(), bundle.stage.numbers.data());
    }
}

// A stage of one column or row has no step along it, and no skew.
std::vector<int> known_of_stage(const StageGrid& stage) {
    std::vector<int> known;
    if (stage.count.x == 1)
        known.push_back(3);
    if (stage.count.y == 1)
        known.push_back(4);
    if (stage.count.x == 1 || stage.count.y == 1)
        known.push_back(5);
    if (stage.count.x == 1 && stage.count.y == 1)
        known.insert(known.begin(), 2);
    return known;
}

void set_known(Bundle& bundle, const Choice& choice, ceres::Problem& problem) {
    if (choice.is_lens_known)
        problem.SetParameterBlockConstant(bundle.lens.data());
    else if (choice.has_square_pixels)
        problem.SetManifold(bundle.lens.data(),
                            new SquarePixels(static_cast<int>(bundle.lens.size())));
    if (choice.is_board_flat)
        problem.SetParameterBlockConstant(bundle.bend_m.data());
    const std::vector<int> known = known_of_stage(bundle.stage);
    if (bundle.has_planes && !known.empty())
        problem.SetManifold(bundle.stage.numbers.data(), new ceres::SubsetManifold(6, known));
}

BundleProblem* problem_of(Bundle& bundle,
                          const Observations& observations,
                          const Weights& weights,
                          const Choice& choice) {
    auto made = std::make_unique<BundleProblem>(choice);
    switch (bundle.model) {
        case rig::LensModel::Brown5:
            add_residuals<rig::LensModel::Brown5>(bundle, observations, weights, *made);
            break;
        case rig::LensModel::Brown8:
            add_residuals<rig::LensModel::Brown8>(bundle, observations, weights, *made);
            break;
        case rig::LensModel::Fisheye:
            add_residuals<rig::LensModel::Fisheye>(bundle, observations, weights, *made);
            break;
    }
    set_known(bundle, choice, made->problem);
    return made.release();
}

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

Eigen::MatrixXd normal_matrix(const ceres::CRSMatrix& jacobian) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
    for (int row = 0; row < jacobian.num_rows; ++row) {
        const auto begin = static_cast<std::size_t>(jacobian.rows[static_cast<std::size_t>(row)]);
        const auto end = static_cast<std::size_t>(jacobian.rows[static_cast<std::size_t>(row) + 1]);
        for (std::size_t i = begin; i < end; ++i) {
            for (std::size_t j = begin; j < end; ++j)
                normal(jacobian.cols[i], jacobian.cols[j]) +=
                    jacobian.values[i] * jacobian.values[j];
        }
    }
    return normal;
}

// The first `count` rows and columns of the inverse; none where it is singular to rounding.
std::optional<Eigen::MatrixXd> inverse_corner(const Eigen::MatrixXd& normal, int count) {
    const Eigen::VectorXd diagonal = normal.diagonal();
    if (!(diagonal.minCoeff() > 0.0))
        return std::nullopt;
    const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::LDLT<Eigen::MatrixXd> factors(scaled);
    constexpr double kSingular = 1e-15;
    if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > kSingular))
        return std::nullopt;
    const Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(normal.rows(), count);
    const Eigen::MatrixXd inverse = factors.solve(unit).topRows(count);
    const auto shared_scale = scale.head(count).asDiagonal();
    return Eigen::MatrixXd(shared_scale * inverse * shared_scale);
}

}  // namespace

int solve(Bundle& bundle,
          const Observations& observations,
          const Weights& weights,
          const Choice& choice) {
    const std::unique_ptr<BundleProblem> made(problem_of(bundle, observations, weights, choice));
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (double* board : made->boards)
        options.linear_solver_ordering->AddElementToGroup(board, 0);
    for (double* block : shared_blocks(bundle))
        options.linear_solver_ordering->AddElementToGroup(block, 1);
    options.num_threads = 1;  // sums in one order: the same bits on every machine's threads
    options.max_num_iterations = 200;
    options.function_tolerance = choice.tolerance;
    options.parameter_tolerance = 1e-14;
    options.gradient_tolerance = 1e-16;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &made->problem, &summary);
    return static_cast<int>(summary.iterations.size());
}

std::optional<SharedCovariance> shared_covariance(Bundle& bundle,
                                                  const Observations& observations,
                                                  const Weights& weights,
                                                  const Choice& choice) {
    const std::unique_ptr<BundleProblem> made(problem_of(bundle, observations, weights, choice));
    const std::vector<double*> shared = shared_blocks(bundle);
    ceres::Problem::EvaluateOptions options;
    options.apply_loss_function = false;
    std::vector<Eigen::MatrixXd> tangents;
    int estimated = 0, ambient = 0;
    for (double* block : shared) {
        tangents.push_back(tangents_of(made->problem, block));
        estimated += static_cast<int>(tangents.back().cols());
        ambient += static_cast<int>(tangents.back().rows());
        if (tangents.back().cols() > 0)
            options.parameter_blocks.push_back(block);
    }
    options.parameter_blocks.insert(options.parameter_blocks.end(), made->boards.begin(),
                                    made->boards.end());
    ceres::CRSMatrix jacobian;
    if (!made->problem.Evaluate(options, nullptr, nullptr, nullptr, &jacobian))
        return std::nullopt;
    const auto inverse = inverse_corner(normal_matrix(jacobian), estimated);
    if (!inverse)
        return std::nullopt;
    Eigen::MatrixXd expand = Eigen::MatrixXd::Zero(ambient, estimated);
    Eigen::Index row = 0, column = 0;
    for (const Eigen::MatrixXd& part : tangents) {
        expand.block(row, column, part.rows(), part.cols()) = part;
        row += part.rows();
        column += part.cols();
    }
    return SharedCovariance{expand * *inverse * expand.transpose(), jacobian.num_cols};
}

}  // namespace nearfield::calibrate
