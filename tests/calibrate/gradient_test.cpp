// SPDX-License-Identifier: Apache-2.0
// Derivatives of every residual against finite differences. (That the values are right is shown by
// lens_test and by the recovery of simulated benches.)
#include "calibrate/bundle_residuals.h"
#include "tests/calibrate/simulated.h"

#include <ceres/ceres.h>
#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>

namespace nearfield::calibrate {
namespace {

using rig::LensModel;

constexpr double kPrecision = 1e-6;  // of Ridders' extrapolated differences
const BoardPoint kPoint{{0.12, 0.06}, {0.4, -0.6}};
const Rigid kAnchor{test::turn_xyz({0.3, -0.2, 0.5}), {-0.1, -0.05, 0.9}};

void expect_slopes(const ceres::CostFunction& residual, std::vector<const double*> parameters) {
    ceres::NumericDiffOptions options;
    const ceres::GradientChecker checker(
        &residual, static_cast<const std::vector<const ceres::Manifold*>*>(nullptr), options);
    ceres::GradientChecker::ProbeResults results;
    EXPECT_TRUE(checker.Probe(parameters.data(), kPrecision, &results)) << results.error_log;
    for (const auto& jacobian : results.jacobians)
        EXPECT_GT(jacobian.norm(), 0.0) << "a residual that does not depend on its parameters";
}

template <LensModel kModel>
void check_model() {
    constexpr int kLens = lens_numbers(kModel);
    const rig::Lens truth = test::simulated_lens(kModel);
    std::vector<double> lens = {truth.fx_px, truth.fy_px, truth.cx_px, truth.cy_px};
    lens.insert(lens.end(), truth.distortion.begin(), truth.distortion.end());
    ASSERT_EQ(lens.size(), static_cast<std::size_t>(kLens));
    const std::array<double, 3> bend = {0.002, -0.001, 0.003};
    const std::array<double, 6> pose = {0.3, -0.4, 0.2, -0.1, 0.05, 0.8};
    const std::array<double, 3> move = {0.02, -0.03, 0.01}, still = {0.0, 0.0, 0.0};
    const std::array<double, 3> place = {0.03, -0.02, 0.7};
    const std::array<double, 6> stage = {0.02, 0.01, 0.4, 0.02, 0.022, 0.01};

    const ceres::AutoDiffCostFunction<FreeCornerResidual<kModel>, 2, kLens, 3, 6> free(
        new FreeCornerResidual<kModel>{kPoint, {260.0, 250.0}, 0.07});
    expect_slopes(free, {lens.data(), bend.data(), pose.data()});
    const ceres::AutoDiffCostFunction<PlacedCornerResidual<kModel>, 2, kLens, 3, 3, 3> placed(
        new PlacedCornerResidual<kModel>{kPoint, {260.0, 250.0}, 0.07, kAnchor});
    expect_slopes(placed, {lens.data(), bend.data(), move.data(), place.data()});
    expect_slopes(placed, {lens.data(), bend.data(), still.data(), place.data()});
    const ceres::AutoDiffCostFunction<FilterResidual<kModel>, 2, kLens, 3, 6> filter(
        new FilterResidual<kModel>{
            {3.0, -2.0}, -1.0, {260.0, 250.0}, glm::dmat2(9.0, 1.0, 2.0, 12.0), kAnchor});
    expect_slopes(filter, {lens.data(), move.data(), stage.data()});
}

TEST(BundleResiduals, SlopesAreThoseOfDifferences) {
    check_model<LensModel::Brown5>();
    check_model<LensModel::Brown8>();
    check_model<LensModel::Fisheye>();
}

}  // namespace
}  // namespace nearfield::calibrate
