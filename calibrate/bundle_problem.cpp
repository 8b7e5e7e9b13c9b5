// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bundle_problem.h"

#include "calibrate/bundle_residuals.h"

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
        to.problem->AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 2, kLens, 3, 6>(
                                         new Residual{point, corner.at_px, sigma_px}),
                                     to.loss.get(), lens, bend, board.numbers.data());
        return;
    }
    PlaneMove& plane = board.plane == capture::TargetPlane::Screen ? bundle.s : bundle.u;
    using Residual = PlacedCornerResidual<kModel>;
    to.problem->AddResidualBlock(
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
        if (is_seen) {
            to.boards.push_back(bundle.boards[view].numbers.data());
            to.views.push_back(view);
        }
    }
    if (!bundle.has_planes)
        return;
    constexpr int kLens = lens_numbers(kModel);
    for (std::size_t i = 0; i < observations.filters.size(); ++i) {
        const FilterView& filter = observations.filters[i];
        using Residual = FilterResidual<kModel>;
        to.problem->AddResidualBlock(
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

}  // namespace

BundleProblem make_problem(Bundle& bundle,
                           const Observations& observations,
                           const Weights& weights,
                           const Choice& choice) {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    BundleProblem made;
    made.loss = loss_of(choice);
    made.problem = std::make_unique<ceres::Problem>(options);
    switch (bundle.model) {
        case rig::LensModel::Brown5:
            add_residuals<rig::LensModel::Brown5>(bundle, observations, weights, made);
            break;
        case rig::LensModel::Brown8:
            add_residuals<rig::LensModel::Brown8>(bundle, observations, weights, made);
            break;
        case rig::LensModel::Fisheye:
            add_residuals<rig::LensModel::Fisheye>(bundle, observations, weights, made);
            break;
    }
    set_known(bundle, choice, *made.problem);
    return made;
}

}  // namespace nearfield::calibrate
