// SPDX-License-Identifier: Apache-2.0
// Corners that are found against corners that are known: half a pixel more or less would show.
#include "calibrate/targets.h"

#include "formats/files/error.h"
#include "tests/calibrate/bench_views.h"
#include "tests/calibrate/simulated.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>

namespace nearfield::calibrate {
namespace {

using sample_data::Bench;
using test::board_of;
using test::target_bench;

// What was found against the truth.
struct CornerErrors {
    int found = 0, visible = 0, views = 0;
    glm::dvec2 sum_px{0.0};
    double square_sum_px2 = 0.0, worst_px = 0.0;

    glm::dvec2 mean_px() const { return sum_px / double(found); }
    double rms_px() const { return std::sqrt(square_sum_px2 / found); }  // of the lengths
    void add(glm::dvec2 error_px) {
        ++found;
        sum_px += error_px;
        square_sum_px2 += glm::dot(error_px, error_px);
        worst_px = std::max(worst_px, glm::length(error_px));
    }
};

std::ostream& operator<<(std::ostream& out, const CornerErrors& errors) {
    return out << errors.found << " of " << errors.visible << " corners in " << errors.views
               << " views, RMS " << errors.rms_px() << " px, worst " << errors.worst_px
               << " px, mean " << errors.mean_px().x << " " << errors.mean_px().y << " px";
}

CornerErrors errors_on(const std::string& name, const std::string& mosaic) {
    const Bench bench = target_bench(name);
    const sample_data::Prepared prepared = sample_data::prepare(bench);
    const sample_data::Places places = sample_data::make_places(bench);
    const capture::BoardPlan board = board_of(bench);
    CornerErrors errors;
    for (std::size_t view = 0; view < bench.targets.views.size(); ++view) {
        const auto true_px = [&](glm::dvec2 board_m) {
            return test::seen_px(bench,
                                 apply(places.bench_from_board[view], glm::dvec3(board_m, 0.0)));
        };
        const glm::ivec2 inner = board.squares - 1;
        for (int id = 0; id < inner.x * inner.y; ++id) {
            const glm::dvec2 at = true_px(corner_board_m(board, id));
            const glm::dvec2 size(bench.camera.size_px);
            errors.visible += at.x > 8 && at.y > 8 && at.x < size.x - 8 && at.y < size.y - 8;
        }
        const std::vector<Corner> corners =
            find_board(test::exposed(*prepared, view), mosaic, board);
        errors.views += !corners.empty();
        for (const Corner& corner : corners)
            errors.add(corner.at_px - true_px(corner.board_m));
    }
    std::cout << name << ": " << errors << "\n";
    return errors;
}

TEST(Targets, CornersOfTheNearBenchAreFound) {
    const CornerErrors errors = errors_on("bench_near.json", "mono");
    EXPECT_GE(errors.found, 0.98 * errors.visible);
    EXPECT_LT(errors.rms_px(), 0.010);
    EXPECT_LT(errors.worst_px, 0.035);
    EXPECT_LT(glm::length(errors.mean_px()), 0.001);  // half a pixel wrong: 0.7
}

TEST(Targets, CornersOfTheFarBenchAreFoundThroughItsMosaic) {
    const CornerErrors errors = errors_on("bench_far.json", "rggb");
    EXPECT_GE(errors.found, 0.98 * errors.visible);
    EXPECT_LT(errors.rms_px(), 0.010);
    EXPECT_LT(errors.worst_px, 0.035);
    EXPECT_LT(glm::length(errors.mean_px()), 0.001);
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
