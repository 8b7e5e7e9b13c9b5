// SPDX-License-Identifier: Apache-2.0
// Corners that are found against corners that are known: half a pixel more or less would show.
#include "calibrate/targets.h"

#include "formats/files/error.h"
#include "tests/calibrate/corner_errors.h"
#include "tests/calibrate/simulated.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>

namespace nearfield::calibrate {
namespace {

using test::board_of;
using test::CornerErrors;
using test::target_bench;

// A few of the pictures; all of them, and what becomes of them: bench_geometry_test.cpp.
void expect_found(const std::string& name, const std::string& mosaic) {
    sample_data::Bench bench = test::target_bench(name);
    bench.targets.views.resize(2);
    const CornerErrors errors = test::errors_of(bench, test::found_corners(bench, mosaic));
    std::cout << name << ": " << errors << "\n";
    EXPECT_EQ(errors.views, 2);
    EXPECT_GE(errors.found, 0.98 * errors.visible);
    EXPECT_LT(errors.rms_px(), 0.010);  // half a pixel wrong: 0.7
    EXPECT_LT(errors.worst_px, 0.035);
}

TEST(Targets, CornersOfTheNearBenchAreFound) {
    expect_found("bench_near.json", "mono");
}

TEST(Targets, CornersOfTheFarBenchAreFoundThroughItsMosaic) {
    expect_found("bench_far.json", "rggb");
}

// A chessboard by 8 x 8 points a pixel, through a pose and a pinhole; its corners are known.
struct DrawnBoard {
    capture::BoardPlan board{capture::BoardKind::Chessboard, {10, 7}, 0.025, 0.0, std::string()};
    double focal_px = 800.0;
    glm::dvec2 center_px{258.3, 254.1};
    Rigid camera_from_board{test::turn_xyz({0.3, -0.4, 0.2}), {-0.12, -0.06, 0.55}};

    glm::dvec2 corner_px(int id) const {
        const glm::dvec3 p = apply(camera_from_board, glm::dvec3(corner_board_m(board, id), 0.0));
        return focal_px * glm::dvec2(p) / p.z + center_px;
    }
    double brightness(glm::dvec2 at_px) const {
        const glm::dvec3 ray((at_px - center_px) / focal_px, 1.0);
        const glm::dmat3 to = glm::transpose(camera_from_board.rotation);
        const glm::dvec3 eye = to * -camera_from_board.translation_m, along = to * ray;
        const glm::dvec2 at = glm::dvec2(eye - along * (eye.z / along.z)) / board.square_m;
        if (at.x < 0 || at.y < 0 || at.x > board.squares.x || at.y > board.squares.y)
            return 0.9;
        return (static_cast<int>(at.x) + static_cast<int>(at.y)) % 2 == 0 ? 0.1 : 0.9;
    }
    capture::Frame picture() const {
        capture::Frame frame{{512, 512}, 1, 8, {}};
        for (int y = 0; y < frame.size_px.y; ++y) {
            for (int x = 0; x < frame.size_px.x; ++x) {
                double sum = 0.0;
                for (int part = 0; part < 64; ++part)
                    sum +=
                        brightness(glm::dvec2(x, y) + (glm::dvec2(part % 8, part / 8) + 0.5) / 8.0);
                frame.values.push_back(static_cast<std::uint16_t>(std::lround(sum / 64.0 * 255.0)));
            }
        }
        return frame;
    }
};

TEST(Targets, AChessboardsCornersAreFound) {
    const DrawnBoard drawn;
    const std::vector<Corner> corners = find_board(drawn.picture(), "mono", drawn.board);
    ASSERT_EQ(corners.size(), 54U);
    CornerErrors errors;
    errors.views = 1;
    errors.visible = 54;
    // The board may be found turned by half a turn: it looks the same, ids start at the other end.
    const bool is_turned = glm::length(corners[0].at_px - drawn.corner_px(0)) > 10.0;
    for (const Corner& corner : corners)
        errors.add(corner.at_px - drawn.corner_px(is_turned ? 53 - corner.id : corner.id));
    std::cout << "chessboard: " << errors << "\n";
    EXPECT_LT(errors.rms_px(), 0.03);  // no blur but the pixels': harder than a lens'
    EXPECT_LT(glm::length(errors.mean_px()), 0.006);
}

TEST(Targets, NoBoardIsAnOrdinaryNo) {
    capture::Frame gray{{320, 240}, 1, 12, std::vector<std::uint16_t>(76800, 1000)};
    const DrawnBoard drawn;
    EXPECT_TRUE(find_board(gray, "mono", drawn.board).empty());
    EXPECT_TRUE(find_board(gray, "rggb", board_of(target_bench("bench_near.json"))).empty());
}

TEST(Targets, UnknownWordsAreRefused) {
    const capture::Frame gray{{64, 64}, 1, 12, std::vector<std::uint16_t>(4096, 1000)};
    capture::BoardPlan board = board_of(target_bench("bench_near.json"));
    EXPECT_THROW(find_board(gray, "rgbw", board), Error);
    board.dictionary = "9x9_50";
    EXPECT_THROW(find_board(gray, "mono", board), Error);
}

}  // namespace
}  // namespace nearfield::calibrate
