// SPDX-License-Identifier: Apache-2.0
// Derivatives of every residual against finite differences. (That the values are right is shown by
// lens_test and by the recovery of simulated benches.) Not by ceres::GradientChecker: it hands over
// Eigen's matrices between code of different alignments, ours with AVX and the library's without.
#include "calibrate/bundle_residuals.h"
#include "tests/calibrate/simulated.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace nearfield::calibrate {
namespace {

using rig::LensModel;

constexpr double kPrecision = 1e-6;  // of central differences with steps of 1e-6
constexpr double kRounding = 1e-4;   // of residuals of 1e3 over steps of 1.5e-8
const BoardPoint kPoint{{0.12, 0.06}, {0.4, -0.6}};
const Rigid kAnchor{test::turn_xyz({0.3, -0.2, 0.5}), {-0.1, -0.05, 0.9}};

using Slopes = std::vector<std::vector<double>>;  // [block][residual * size + number]

Slopes slopes_of(const ceres::CostFunction& residual, const std::vector<const double*>& at) {
    Slopes slopes;
    std::vector<double*> pointers;
    for (const int size : residual.parameter_block_sizes())
        slopes.emplace_back(static_cast<std::size_t>(2 * size));
    for (std::vector<double>& block : slopes)
        pointers.push_back(block.data());
    std::array<double, 2> value{};
    EXPECT_TRUE(residual.Evaluate(at.data(), value.data(), pointers.data()));
    return slopes;
}

template <typename Residual, int... kSizes>
void expect_slopes(const Residual& residual, const std::vector<const double*>& at) {
    const ceres::AutoDiffCostFunction<Residual, 2, kSizes...> automatic(new Residual(residual));
    const ceres::NumericDiffCostFunction<Residual, ceres::CENTRAL, 2, kSizes...> numeric(
        new Residual(residual));
    const Slopes ours = slopes_of(automatic, at), differences = slopes_of(numeric, at);
    for (std::size_t block = 0; block < ours.size(); ++block) {
        double largest = 0.0;
        for (const double slope : differences[block])
            largest = std::max(largest, std::abs(slope));
        EXPECT_GT(largest, 0.0) << "block " << block << " does not matter";
        for (std::size_t i = 0; i < ours[block].size(); ++i)
            EXPECT_NEAR(ours[block][i], differences[block][i], kPrecision * largest + kRounding)
                << "block " << block << ", slope " << i;
    }
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

    using Free = FreeCornerResidual<kModel>;
    const Free free{kPoint, {260.0, 250.0}, 0.07};
    expect_slopes<Free, kLens, 3, 6>(free, {lens.data(), bend.data(), pose.data()});
    using Placed = PlacedCornerResidual<kModel>;
    const Placed placed{kPoint, {260.0, 250.0}, 0.07, kAnchor};
    expect_slopes<Placed, kLens, 3, 3, 3>(placed,
                                          {lens.data(), bend.data(), move.data(), place.data()});
    expect_slopes<Placed, kLens, 3, 3, 3>(placed,
                                          {lens.data(), bend.data(), still.data(), place.data()});
    using Filter = FilterResidual<kModel>;
    const Filter filter{
        {3.0, -2.0}, -1.0, {260.0, 250.0}, glm::dmat2(9.0, 1.0, 2.0, 12.0), kAnchor};
    expect_slopes<Filter, kLens, 3, 6>(filter, {lens.data(), move.data(), stage.data()});
}

TEST(BundleResiduals, SlopesAreThoseOfDifferences) {
    check_model<LensModel::Brown5>();
    check_model<LensModel::Brown8>();
    check_model<LensModel::Fisheye>();
}

}  // namespace
}  // namespace nearfield::calibrate
