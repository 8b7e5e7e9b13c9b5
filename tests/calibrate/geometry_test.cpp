// SPDX-License-Identifier: Apache-2.0
// Simulated benches are recovered: exactly without noise, within the predicted sigmas with it.
#include "calibrate/geometry.h"

#include "tests/calibrate/simulated.h"
#include "tests/calibrate/truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

namespace nearfield::calibrate {
namespace {

using rig::LensModel;
using test::SimulatedBench;

const Rigid& slab_of(const Geometry& found) {
    return found.planes->planes.camera_from_slab;
}

double angle_between(const glm::dmat3& a, const glm::dmat3& b) {
    const glm::dmat3 c = glm::transpose(a) * b;
    return glm::length(glm::dvec3(c[1].z - c[2].y, c[2].x - c[0].z, c[0].y - c[1].x)) / 2.0;
}

void expect_poses(const Geometry& found, const SimulatedBench& truth, double tolerance) {
    for (const ViewResult& view : found.views) {
        const Rigid& pose = truth.camera_from_board[static_cast<std::size_t>(view.view)];
        EXPECT_LT(angle_between(view.camera_from_board.rotation, pose.rotation), tolerance);
        EXPECT_LT(glm::length(view.camera_from_board.translation_m - pose.translation_m),
                  tolerance);
    }
    const rig::Planes& planes = found.planes->planes;
    EXPECT_LT(angle_between(planes.camera_from_slab.rotation, truth.camera_from_slab.rotation),
              tolerance);
    for (int row = 0; row < truth.grid.y; ++row) {
        for (int column = 0; column < truth.grid.x; ++column) {
            const auto index = static_cast<std::size_t>(row * truth.grid.x + column);
            EXPECT_LT(glm::length(planes.position_m[index] - truth.center_slab({column, row})),
                      tolerance);
        }
    }
}

class EveryModel : public testing::TestWithParam<LensModel> {};

TEST_P(EveryModel, PerfectCornersAreRecovered) {
    const SimulatedBench truth = test::simulated_bench(GetParam(), 8, 0.0);
    GeometryOptions options;
    options.lens_model = GetParam();
    const Geometry found = calibrate_geometry(test::observed(truth, {}), options);
    EXPECT_LT(found.rms_px, 1e-9);
    EXPECT_TRUE(found.outliers.empty());
    for (const rig::Parameter& parameter : found.parameters) {
        const double value = test::true_parameter(truth, parameter.name, slab_of(found));
        // Numbers of a rational lens are nearly interchangeable: what they do is recovered.
        if (GetParam() != LensModel::Brown8 || parameter.name[0] != 'k') {
            EXPECT_NEAR(parameter.value, value, 1e-9 * std::max(1.0, std::abs(value)))
                << parameter.name;
        }
    }
    for (const glm::dvec2 at_px : found.uncertainty.at_px) {
        const auto seen = rig::project_px(found.lens, *rig::ray_camera(truth.lens, at_px));
        EXPECT_LT(glm::length(*seen - at_px), 1e-7);
    }
    expect_poses(found, truth, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Geometry,
                         EveryModel,
                         testing::Values(LensModel::Brown5, LensModel::Brown8, LensModel::Fisheye),
                         [](const auto& model) {
                             return std::string(model.param == LensModel::Brown5   ? "Brown5"
                                                : model.param == LensModel::Brown8 ? "Brown8"
                                                                                   : "Fisheye");
                         });

TEST(Geometry, NoisyCornersAreRecoveredWithinTheirSigmas) {
    const SimulatedBench truth = test::simulated_bench(LensModel::Brown5, 12, 2e-5);
    const Geometry found = calibrate_geometry(test::observed(truth, {5, 0.05, 0.02}), {});
    EXPECT_NEAR(found.corner_sigma_px, 0.05, 0.004);  // 1100 numbers: 2 %, four times that
    for (const rig::Parameter& parameter : found.parameters) {
        const double off =
            (parameter.value - test::true_parameter(truth, parameter.name, slab_of(found))) /
            parameter.sigma;
        EXPECT_LT(std::abs(off), 3.0) << parameter.name << " +- " << parameter.sigma;
        EXPECT_GT(parameter.sigma, 0.0) << parameter.name;
    }
    const PlanesResult& planes = *found.planes;
    ASSERT_TRUE(planes.is_step_sigma_known);
    // 18 numbers less 6: the estimate is good to 20 %.
    EXPECT_GT(planes.step_sigma_m, 0.8e-5);
    EXPECT_LT(planes.step_sigma_m, 4e-5);
    double chi2 = 0.0;
    for (int i = 0; i < 63; ++i) {
        const auto index = static_cast<std::size_t>(i);
        const glm::dvec3 error =
            planes.planes.position_m[index] - truth.center_slab({i % 9, i / 9});
        chi2 += glm::dot(glm::dvec2(error), glm::dvec2(error)) /
                (planes.position_sigma_m[index] * planes.position_sigma_m[index]);
    }
    // 126 numbers, but sigma itself is good to 20 %.
    EXPECT_NEAR(chi2 / 126.0, 1.0, 0.6);
    std::cout << "delta " << planes.planes.delta_m << " m, f " << found.lens.fx_px << " px, step "
              << planes.step_sigma_m << " m, time " << found.time_s << " s\n";
}

// A position that was seen is known better than the stage's noise; one that was not, not.
TEST(Geometry, SeenPositionsAreKnownBetter) {
    const SimulatedBench truth = test::simulated_bench(LensModel::Brown5, 8, 5e-5);
    GeometryOptions options;
    options.with_validation = false;
    const Geometry found = calibrate_geometry(test::observed(truth, {5, 0.03, 0.01}), options);
    const PlanesResult& planes = *found.planes;
    EXPECT_LT(planes.position_sigma_m[0], 0.4 * planes.step_sigma_m);
    EXPECT_GT(planes.position_sigma_m[1], planes.step_sigma_m);
    ASSERT_EQ(planes.filters.size(), 9U);
    for (const FilterResult& filter : planes.filters) {
        const auto index = static_cast<std::size_t>(filter.position.y * 9 + filter.position.x);
        const glm::dvec2 error_m(planes.planes.position_m[index] -
                                 truth.center_slab(filter.position));
        EXPECT_LT(glm::length(error_m), 5.0 * planes.position_sigma_m[index]);
    }
}

TEST(Geometry, OutliersAreNamedAndLeftOut) {
    const SimulatedBench truth = test::simulated_bench(LensModel::Brown5, 12, 2e-5);
    Observations seen = test::observed(truth, {6, 0.05, 0.02});
    struct Planted {
        std::size_t view, corner;
        glm::dvec2 by_px;
    };
    const std::vector<Planted> planted = {
        {1, 3, {4.0, 0.0}}, {4, 10, {-0.6, 0.5}}, {4, 11, {20.0, 9.0}}, {9, 30, {0.0, -1.0}}};
    for (const Planted& p : planted)
        seen.boards[p.view].corners[p.corner].at_px += p.by_px;
    const Geometry found = calibrate_geometry(seen, {});
    ASSERT_EQ(found.outliers.size(), planted.size());
    for (std::size_t i = 0; i < planted.size(); ++i) {
        EXPECT_EQ(found.outliers[i].view, static_cast<int>(planted[i].view));
        EXPECT_EQ(found.outliers[i].corner,
                  seen.boards[planted[i].view].corners[planted[i].corner].id);
        EXPECT_NEAR(found.outliers[i].residual_px, glm::length(planted[i].by_px), 0.3);
    }
    EXPECT_NEAR(found.corner_sigma_px, 0.05, 0.004);
    for (const rig::Parameter& parameter : found.parameters)
        EXPECT_LT(
            std::abs(parameter.value - test::true_parameter(truth, parameter.name, slab_of(found))),
            3.5 * parameter.sigma)
            << parameter.name;
}

// A decentered lens taken for one that is radial: residuals, and views that were not fitted.
TEST(Geometry, AWrongModelShowsInHeldOutViewsAndHalves) {
    SimulatedBench truth = test::simulated_bench(LensModel::Brown5, 16, 0.0);
    truth.lens.distortion = {-0.11, 0.09, 0.02, -0.015, 0.02};
    const Observations seen = test::observed(truth, {8, 0.05, 0.02});
    GeometryOptions right, wrong;
    right.with_planes = wrong.with_planes = false;
    right.lens_model = LensModel::Brown5;
    wrong.lens_model = LensModel::Fisheye;
    const Geometry good = calibrate_geometry(seen, right), bad = calibrate_geometry(seen, wrong);
    // Two numbers a corner of 0.05 px each.
    EXPECT_NEAR(good.held_out->rms_px, 0.0707, 0.006);
    EXPECT_GT(bad.held_out->rms_px, 1.3 * good.held_out->rms_px);
    // Halves of the right model differ by what they should, within a factor that few views allow.
    EXPECT_LT(good.halves->difference_rms_px, 2.0 * good.halves->predicted_rms_px);
    EXPECT_GT(good.halves->difference_rms_px, 0.2 * good.halves->predicted_rms_px);
    std::cout << "held out: " << good.held_out->rms_px << " px, wrong model "
              << bad.held_out->rms_px << " px; halves " << good.halves->difference_rms_px << " of "
              << good.halves->predicted_rms_px << " px, wrong model "
              << bad.halves->difference_rms_px << " of " << bad.halves->predicted_rms_px << "\n";
}

TEST(Geometry, ABentBoardIsNoticed) {
    SimulatedBench truth = test::simulated_bench(LensModel::Brown5, 14, 0.0);
    GeometryOptions options;
    options.with_planes = false;
    const Geometry flat = calibrate_geometry(test::observed(truth, {9, 0.05, 0.02}), options);
    EXPECT_LT(flat.bend->significance_sigma, 3.0);
    truth.bend_m = {6e-4, -3e-4};
    const Geometry bent = calibrate_geometry(test::observed(truth, {9, 0.05, 0.02}), options);
    EXPECT_GT(bent.bend->significance_sigma, 5.0);
    EXPECT_LT(std::abs(bent.bend->bend_m.x - 6e-4), 3.5 * bent.bend->sigma_m.x);
    EXPECT_LT(std::abs(bent.bend->bend_m.y), 3.5 * bent.bend->sigma_m.y);
    EXPECT_LT(std::abs(bent.bend->bend_m.z + 3e-4), 3.5 * bent.bend->sigma_m.z);
    EXPECT_LT(bent.bend->sigma_m.x, 1.5e-4);
    std::cout << "bend " << bent.bend->bend_m.x << " +- " << bent.bend->sigma_m.x << " m, "
              << bent.bend->significance_sigma << " sigma; flat " << flat.bend->significance_sigma
              << " sigma\n";
}

// Against a search of its own over S: rays from where the picture's edge sees S through the true
// centers, crossing z = -delta, and the true centers against a regular grid.
TEST(Geometry, ParallelPlanesCostWhatTheTiltSays) {
    const SimulatedBench truth = test::simulated_bench(LensModel::Brown5, 8, 0.0);
    GeometryOptions options;
    options.with_validation = false;
    const Geometry found = calibrate_geometry(test::observed(truth, {}), options);
    const glm::dmat3 slab_from_camera = glm::transpose(truth.camera_from_slab.rotation);
    const glm::dvec3 eye = slab_from_camera * -truth.camera_from_slab.translation_m;
    double center_m = 0.0, position_m = 0.0, direction_rad = 0.0;
    for (int i = 0; i < 63; ++i) {
        const glm::dvec3 center = truth.center_slab({i % 9, i / 9});
        const glm::dvec2 steps(i % 9 - 4, i / 9 - 3);
        center_m = std::max(center_m, glm::length(glm::dvec2(center) - steps * truth.pitch_m));
        for (const glm::dvec2 at_px :
             {glm::dvec2(0, 0), glm::dvec2(512, 0), glm::dvec2(0, 512), glm::dvec2(512, 512)}) {
            const glm::dvec3 along = slab_from_camera * *rig::ray_camera(truth.lens, at_px);
            const glm::dvec3 s = eye - along * (eye.z / along.z);
            const double share = (s.z + truth.delta_m) / (s.z - center.z);
            const glm::dvec3 crossing = s + (center - s) * share;
            position_m = std::max(position_m, glm::length(glm::dvec2(crossing - center)));
            const glm::dvec3 taken(center.x, center.y, -truth.delta_m);
            direction_rad = std::max(direction_rad, std::acos(glm::dot(glm::normalize(s - center),
                                                                       glm::normalize(s - taken))));
        }
    }
    const ParallelCost& cost = found.planes->parallel;
    EXPECT_NEAR(cost.center_most_m, center_m, 1e-8);
    EXPECT_NEAR(cost.position_m, position_m, 1e-8);
    // The steepest change of direction need not be in the picture's corner.
    EXPECT_GE(cost.direction_rad, direction_rad - 1e-6);
    EXPECT_LE(cost.direction_rad, 1.3 * direction_rad);
    std::cout << "taken for parallel: " << position_m << " m, " << direction_rad << " rad\n";
}

TEST(Geometry, SquarePixelsShareOneFocalLength) {
    SimulatedBench truth = test::simulated_bench(LensModel::Brown5, 10, 0.0);
    truth.lens.fy_px = truth.lens.fx_px;
    GeometryOptions options;
    options.with_validation = false;
    options.has_square_pixels = true;
    const Geometry found = calibrate_geometry(test::observed(truth, {3, 0.05, 0.02}), options);
    EXPECT_EQ(found.parameters[0].sigma, found.parameters[1].sigma);
    EXPECT_NEAR(found.lens.fx_px, found.lens.fy_px, 1e-9);
    EXPECT_LT(std::abs(found.lens.fx_px - 800.0), 3.5 * found.parameters[0].sigma);
}

}  // namespace
}  // namespace nearfield::calibrate
