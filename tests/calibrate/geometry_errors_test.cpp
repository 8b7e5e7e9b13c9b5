// SPDX-License-Identifier: Apache-2.0
// Pictures that cannot tell the geometry are refused, with what to do.
#include "calibrate/geometry.h"
#include "formats/files/error.h"
#include "tests/calibrate/simulated.h"

#include <gtest/gtest.h>

#include <string>

namespace nearfield::calibrate {
namespace {

using capture::TargetPlane;
using rig::LensModel;
using test::SimulatedBench;

GeometryOptions quick() {
    GeometryOptions options;
    options.with_validation = false;
    return options;
}

Observations good() {
    return test::observed(test::simulated_bench(LensModel::Brown5, 8, 0.0), {2, 0.05, 0.02});
}

// Expects an Error whose text holds all of `words`.
void expect_refused(const Observations& seen,
                    const std::vector<std::string>& words,
                    const GeometryOptions& options = quick()) {
    try {
        calibrate_geometry(seen, options);
        ADD_FAILURE() << "was not refused: " << words.front();
    } catch (const Error& error) {
        const std::string text = error.what();
        for (const std::string& word : words)
            EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
    }
}

void remove_plane(Observations& seen, TargetPlane plane) {
    for (BoardView& view : seen.boards) {
        if (view.plane == plane)
            view.plane = TargetPlane::Free;
    }
}

TEST(GeometryErrors, GoodViewsAreNotRefused) {
    EXPECT_NO_THROW(calibrate_geometry(good(), quick()));
}

TEST(GeometryErrors, TooFewBoardsAreNamed) {
    Observations seen = good();
    for (std::size_t view = 2; view < seen.boards.size(); ++view)
        seen.boards[view].corners.clear();
    seen.boards[5].corners = good().boards[5].corners;
    seen.boards[5].corners.resize(4);
    expect_refused(seen, {"at least 3", "view 3: no board found", "view 5: 4 corners"});
}

TEST(GeometryErrors, CornersOnALineAreNoBoard) {
    Observations seen = good();
    std::vector<Corner>& corners = seen.boards[6].corners;
    std::erase_if(corners, [](const Corner& corner) { return corner.id >= 7; });
    const Geometry found = calibrate_geometry(seen, quick());
    ASSERT_EQ(found.unused.size(), 1U);
    EXPECT_EQ(found.unused[0].name, "view 6");
    EXPECT_EQ(found.views.size(), 11U);
}

TEST(GeometryErrors, ParallelBoardsDoNotTellTheFocalLength) {
    for (const double noise_px : {0.0, 0.05}) {
        SimulatedBench bench = test::simulated_bench(LensModel::Brown5, 0, 0.0);
        bench.u_tilt_rad = {0.0, 0.0};
        bench.camera_from_slab.rotation = glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1);
        bench.camera_from_slab.translation_m = {0.0, 0.0, 0.8};
        bench.camera_from_board.clear();
        bench.planes.clear();
        for (const double z_m : {0.6, 0.8, 1.0, 1.1}) {
            bench.planes.push_back(TargetPlane::Free);
            bench.camera_from_board.push_back({glm::dmat3(1.0), {-0.12, -0.09, z_m}});
        }
        GeometryOptions options = quick();
        options.with_planes = false;
        expect_refused(test::observed(bench, {1, noise_px, 0.0}), {"tilted", "focal length"},
                       options);
    }
}

TEST(GeometryErrors, PicturesOfAnotherSizeAreRefused) {
    Observations seen = good();
    seen.size_px = {256, 256};
    expect_refused(seen, {"of one size", "256 x 256"});
}

TEST(GeometryErrors, PlanesNeedBoardsOnBoth) {
    Observations seen = good();
    remove_plane(seen, TargetPlane::Screen);
    expect_refused(seen, {"on the screen", "flat against the screen"});
    GeometryOptions lens_alone = quick();
    lens_alone.with_planes = false;
    EXPECT_FALSE(calibrate_geometry(seen, lens_alone).planes);
    seen = good();
    remove_plane(seen, TargetPlane::Filter);
    expect_refused(seen, {"on the filter", "take the screen away"});
}

TEST(GeometryErrors, FilterViewsMustSpanTheGrid) {
    Observations seen = good();
    seen.filters.clear();
    expect_refused(seen, {"views of the filter", "at least 3"});
    seen = good();
    std::erase_if(seen.filters, [](const FilterView& filter) { return filter.position.y != 3; });
    expect_refused(seen, {"not on one line"});
    seen = good();
    seen.filters[0].position = {9, 0};
    expect_refused(seen, {"within 9 x 7", "(9, 0)"});
    seen = good();
    seen.grid = {0, 7};
    expect_refused(seen, {"grid"});
}

TEST(GeometryErrors, MirroredPositionsAreNoticed) {
    Observations seen = good();
    for (FilterView& filter : seen.filters)
        filter.position.y = 6 - filter.position.y;
    expect_refused(seen, {"mirrored"});
}

TEST(GeometryErrors, OneRowOfPositionsIsEnoughForAStageOfOneRow) {
    SimulatedBench bench = test::simulated_bench(LensModel::Brown5, 8, 0.0);
    bench.grid = {9, 1};
    bench.skew_rad = 0.0;
    bench.filter_positions = {{0, 0}, {4, 0}, {8, 0}};
    const Geometry found = calibrate_geometry(test::observed(bench, {}), quick());
    const rig::Planes& planes = found.planes->planes;
    EXPECT_NEAR(planes.delta_m, bench.delta_m, 1e-9);
    EXPECT_NEAR(planes.pitch_m.x, bench.pitch_m.x, 1e-9);
    EXPECT_LT(glm::length(planes.position_m[8] - bench.center_slab({8, 0})), 1e-9);
    EXPECT_FALSE(found.planes->is_step_sigma_known);
}

}  // namespace
}  // namespace nearfield::calibrate
