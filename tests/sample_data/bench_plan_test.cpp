// SPDX-License-Identifier: Apache-2.0
// The sample plans say of the sample benches what a lab would know, to the digits it would know.
#include "formats/capture/plan.h"
#include "formats/model/profile.h"
#include "sample_data/bench/places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace nearfield::sample_data {
namespace {

using capture::TargetPlane;

class SamplePlan : public testing::TestWithParam<std::string> {
  protected:
    const std::string folder_ = std::string(NEARFIELD_SOURCE_DIR) + "/sample_data/";
    const Bench bench_ = read_bench(folder_ + "bench_" + GetParam() + ".json");
    const capture::Plan plan_ = capture::read_plan(folder_ + "plan_" + GetParam() + ".json");
};

TEST_P(SamplePlan, KnowsBoardViewsAndPositions) {
    ASSERT_TRUE(plan_.board.has_value());
    EXPECT_EQ(plan_.board->squares, bench_.targets.board.squares);
    EXPECT_EQ(plan_.board->square_m, bench_.targets.board.square_m);
    EXPECT_EQ(plan_.board->marker_m, bench_.targets.board.marker_m);
    EXPECT_EQ(plan_.grid, bench_.filter.grid);
    EXPECT_NEAR(plan_.pitch_m.x, bench_.filter.pitch_m.x, 1e-6);
    EXPECT_NEAR(plan_.pitch_m.y, bench_.filter.pitch_m.y, 1e-6);
    EXPECT_EQ(plan_.basis, bench_.filter.profile.name);
    ASSERT_EQ(plan_.views.size(), bench_.targets.views.size());
    for (std::size_t k = 0; k < plan_.views.size(); ++k) {
        const BoardPlane plane = bench_.targets.views[k].plane;
        EXPECT_EQ(plan_.views[k], plane == BoardPlane::Screen   ? TargetPlane::Screen
                                  : plane == BoardPlane::Filter ? TargetPlane::Filter
                                                                : TargetPlane::Free);
    }
}

// Every square's corner is in the picture, hands' errors included.
TEST_P(SamplePlan, ShowsBoardsAsAWhole) {
    const Places places = make_places(bench_);
    const BenchBoard& board = bench_.targets.board;
    for (std::size_t view = 0; view < places.bench_from_board.size(); ++view) {
        for (int row = 0; row <= board.squares.y; ++row) {
            for (int column = 0; column <= board.squares.x; ++column) {
                const glm::dvec3 corner(column * board.square_m, row * board.square_m, 0.0);
                const std::optional<glm::dvec2> seen_px =
                    project_px(bench_.camera, apply(inverse(bench_.camera.bench_from_camera),
                                                    apply(places.bench_from_board[view], corner)));
                ASSERT_TRUE(seen_px.has_value());
                const bool is_inside = seen_px->x > 0 && seen_px->y > 0 &&
                                       seen_px->x < bench_.camera.size_px.x &&
                                       seen_px->y < bench_.camera.size_px.y;
                EXPECT_TRUE(is_inside) << view << ": " << column << " " << row;
            }
        }
    }
}

TEST_P(SamplePlan, PutsThePhotometerWhereItIs) {
    ASSERT_TRUE(plan_.photometer.has_value());
    const Rigid board = make_places(bench_).bench_from_board.front();
    ASSERT_EQ(plan_.views.front(), TargetPlane::Screen);
    const glm::dvec3 place = apply(board, glm::dvec3(plan_.photometer->on_screen_board_m, 0.0));
    EXPECT_LT(glm::distance(place, bench_.photometer.position_m), 1e-6);
    // The board's z points into the screen, to the lamp: so does the photometer.
    EXPECT_LT(glm::distance(board.rotation[2], bench_.photometer.normal), 1e-9);
    EXPECT_EQ(plan_.photometer->sigma_rel, bench_.photometer.sigma_rel);
    // The correction of its certificate is that of the headlight's white behind the filter.
    const glm::dvec3 color = glm::dvec3(1.02, 1.0, 0.9411) * bench_.filter.transmission;
    const glm::dvec3 luminance(0.2126, 0.7152, 0.0722);
    const double reading = glm::dot(bench_.photometer.channel_factor * luminance, color);
    EXPECT_NEAR(plan_.photometer->correction, glm::dot(luminance, color) / reading, 1e-4);
    EXPECT_LE(plan_.photometer->mismatch_rel, 0.005);
}

TEST_P(SamplePlan, KnowsScreenFilterAndColors) {
    for (std::size_t k = 0; k < plan_.screen.angle_deg.size(); ++k) {
        const double cosine = std::cos(plan_.screen.angle_deg[k] * std::numbers::pi / 180.0);
        const double lobe =
            1.0 - bench_.screen.lobe_share +
            bench_.screen.lobe_share * std::pow(cosine, bench_.screen.lobe_exponent);
        EXPECT_NEAR(plan_.screen.factor[k], lobe, 1e-4);
    }
    EXPECT_GE(plan_.screen.angle_deg.size(), 10U);
    const double center = model::eval(bench_.filter.profile, 0.0);
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(plan_.filter_peak[channel],
                    bench_.filter.transmission[channel] * center * center, 6e-4);
    if (bench_.camera.mosaic == Mosaic::Mono)
        return;
    // White-balanced raw colors of a scene's color, back to it.
    const glm::dmat3& response = bench_.camera.response_e_per_cd_m2_s;
    const glm::dvec3 white = response * glm::dvec3(1.0);
    for (const glm::dvec3 color :
         {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0.2, 0.5, 1)})
        EXPECT_LT(glm::distance(plan_.camera.rgb_from_raw * (response * color / white), color),
                  3e-3);
}

INSTANTIATE_TEST_SUITE_P(Benches, SamplePlan, testing::Values("near", "far"));

}  // namespace
}  // namespace nearfield::sample_data
