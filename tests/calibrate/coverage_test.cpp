// SPDX-License-Identifier: Apache-2.0
// Sigmas are what they say: of many calibrations of one bench with other noise, 68 % must lie
// within one sigma of the truth. This says nothing about errors that are not noise of corners.
#include "calibrate/geometry.h"
#include "tests/calibrate/simulated.h"
#include "tests/calibrate/truth.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstddef>
#include <iostream>
#include <vector>

namespace nearfield::calibrate {
namespace {

constexpr std::size_t kRuns = 200;

TEST(Coverage, OneSigmaHoldsTwoThirdsOfCalibrations) {
    const test::SimulatedBench truth = test::simulated_bench(rig::LensModel::Brown5, 10, 0.0);
    GeometryOptions options;
    options.with_validation = false;
    std::vector<Geometry> found(kRuns);
    tbb::parallel_for(std::size_t{0}, kRuns, [&](std::size_t run) {
        found[run] = calibrate_geometry(test::observed(truth, {1000 + run, 0.05, 0.02}), options);
    });
    std::size_t pooled = 0, outliers = 0;
    double time_s = 0.0;
    const std::vector<std::string>& names = found[0].covariance_of;
    for (std::size_t i = 0; i < names.size(); ++i) {
        std::size_t within = 0;
        double square_sum = 0.0;
        for (const Geometry& geometry : found) {
            const double value =
                test::true_parameter(truth, names[i], geometry.planes->planes.camera_from_slab);
            const double off =
                (geometry.parameters[i].value - value) / geometry.parameters[i].sigma;
            within += std::abs(off) < 1.0;
            square_sum += off * off;
        }
        pooled += within;
        const double share = double(within) / kRuns;
        std::cout << names[i] << ": " << 100.0 * share << " %, RMS "
                  << std::sqrt(square_sum / kRuns) << " sigma\n";
        // 68.3 +- 3.3 % for 200 runs: four of these.
        EXPECT_GE(share, 0.55) << names[i];
        EXPECT_LE(share, 0.80) << names[i];
    }
    const double share = double(pooled) / double(kRuns * names.size());
    for (const Geometry& geometry : found) {
        outliers += geometry.outliers.size();
        time_s += geometry.time_s;
    }
    std::cout << "pooled " << 100.0 * share << " %, " << outliers << " outliers, " << time_s / kRuns
              << " s each\n";
    EXPECT_GE(share, 0.62);
    EXPECT_LE(share, 0.74);
    EXPECT_LT(time_s / kRuns, 0.5);
}

TEST(Coverage, PosesLieWithinTheirSigmas) {
    const test::SimulatedBench truth = test::simulated_bench(rig::LensModel::Brown5, 10, 0.0);
    GeometryOptions options;
    options.with_validation = false;
    std::vector<Geometry> found(kRuns / 2);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t run) {
        found[run] = calibrate_geometry(test::observed(truth, {9000 + run, 0.05, 0.02}), options);
    });
    std::size_t within = 0, count = 0;
    for (const Geometry& geometry : found) {
        for (const ViewResult& view : geometry.views) {
            if (view.plane != capture::TargetPlane::Free)
                continue;
            const Rigid& pose = truth.camera_from_board[static_cast<std::size_t>(view.view)];
            const glm::dvec3 off = view.camera_from_board.translation_m - pose.translation_m;
            for (int axis = 0; axis < 3; ++axis) {
                within += std::abs(off[axis]) < view.pose_sigma[3 + static_cast<std::size_t>(axis)];
                ++count;
            }
        }
    }
    const double share = double(within) / double(count);
    std::cout << "places of boards: " << 100.0 * share << " % of " << count << "\n";
    // Those of one run rise and fall together, by the lens: as good as some hundreds.
    EXPECT_GE(share, 0.60);
    EXPECT_LE(share, 0.76);
}

// The uncertainty map says how far the lens' pictures of far points lie from the true ones, turned.
TEST(Coverage, UncertaintyMapPredictsTheSpreadOfProjections) {
    const test::SimulatedBench truth = test::simulated_bench(rig::LensModel::Brown5, 10, 0.0);
    GeometryOptions options;
    options.with_planes = false;
    std::vector<Geometry> found(kRuns / 4);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t run) {
        found[run] = calibrate_geometry(test::observed(truth, {5000 + run, 0.05, 0.02}), options);
    });
    double ratio2 = 0.0;
    for (const Geometry& geometry : found) {
        const double ratio = geometry.halves->difference_rms_px / geometry.halves->predicted_rms_px;
        ratio2 += ratio * ratio / double(found.size());
    }
    std::cout << "halves differ by " << std::sqrt(ratio2) << " of what is predicted\n";
    // 50 pairs; each is a square of some five numbers that matter: 9 % of the mean square.
    EXPECT_NEAR(std::sqrt(ratio2), 1.0, 0.2);
}

}  // namespace
}  // namespace nearfield::calibrate
