// SPDX-License-Identifier: Apache-2.0
// Board pictures against the board's definition: markers decode where a projection written here
// puts them, and corners lie there to a few hundredths of a pixel. (That OpenCV finds the same
// board is checked by hand: docs/virtual_bench.md.)
#include "sample_data/bench/prepared.h"
#include "tests/sample_data/bench_small.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

namespace nearfield::sample_data {
namespace {

// The first 24 markers of DICT_4X4_50, bits row by row, as printed by OpenCV 4.6.
constexpr std::array<unsigned, 24> kMarkers = {
    0xb532, 0x0f9a, 0x332d, 0x9946, 0x549e, 0x79cd, 0x9e2e, 0xc4f2, 0xfeda, 0xcf56, 0xf991, 0x11a7,
    0x0eb7, 0x2a0f, 0x24b1, 0x263e, 0x4665, 0x6600, 0x6c5e, 0x76af, 0x868b, 0xb02b, 0xccd5, 0xdd82};

Bench target_bench() {
    Bench bench = test::small_bench();
    bench.setup = Setup::Direct;  // targets alone: no light on a screen to compute
    bench.filter.grid = {1, 1};
    BenchCamera& camera = bench.camera;
    camera.size_px = {320, 240};
    camera.fx_px = 420;
    camera.fy_px = 424;
    camera.cx_px = 163;
    camera.cy_px = 118;
    camera.bench_from_camera.rotation = {1, 0, 0, 0, -1, 0, 0, 0, -1};
    camera.bench_from_camera.translation_m = {0.0, 0.0, 0.5};
    camera.vignetting_cos4 = 0.0;
    camera.vignetting = glm::dvec3(0.0);
    bench.accuracy.subsamples = 2;
    bench.targets.board.marker_m = 0.0225;
    TargetView view;
    view.plane = BoardPlane::Free;
    // Facing the camera, turned by asin(0.28) about the board's own y, then by asin(0.6) about x.
    view.plane_from_board.rotation = glm::dmat3(1, 0, 0, 0, -0.8, -0.6, 0, 0.6, -0.8) *
                                     glm::dmat3(0.96, 0, 0.28, 0, 1, 0, -0.28, 0, 0.96);
    view.plane_from_board.translation_m = {-0.11, 0.075, -0.05};
    bench.targets.views = {view};
    return bench;
}

glm::dvec2 projected_px(const Bench& bench, glm::dvec2 on_board_m) {
    const Rigid& board = bench.targets.views[0].plane_from_board;
    const Rigid& eye = bench.camera.bench_from_camera;
    const glm::dvec3 p =
        glm::transpose(eye.rotation) *
        (board.rotation * glm::dvec3(on_board_m, 0.0) + board.translation_m - eye.translation_m);
    const BenchCamera& c = bench.camera;
    const double x = p.x / p.z, y = p.y / p.z, r2 = x * x + y * y;
    const double radial = 1.0 + c.k1 * r2 + c.k2 * r2 * r2 + c.k3 * r2 * r2 * r2;
    return {c.fx_px * (x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x)) + c.cx_px,
            c.fy_px * (y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y) + c.cy_px};
}

// The picture between pixel centers, linearly.
double bright(const std::vector<float>& picture, glm::dvec2 at_px) {
    const glm::dvec2 p = at_px - 0.5;
    const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
    const double u = p.x - x, v = p.y - y;
    const auto value = [&](int column, int row) {
        return double(picture[static_cast<std::size_t>(row * 320 + column)]);
    };
    return (1 - v) * ((1 - u) * value(x, y) + u * value(x + 1, y)) +
           v * ((1 - u) * value(x, y + 1) + u * value(x + 1, y + 1));
}

std::vector<float> board_picture(const Bench& bench) {
    Shot shot;
    shot.subject = Subject::Target;
    return signal_e_per_s(*prepare(bench), shot);
}

TEST(BenchTarget, MarkersDecodeWhereTheyAreProjected) {
    const Bench bench = target_bench();
    const std::vector<float> picture = board_picture(bench);
    const BenchBoard& board = bench.targets.board;
    const double white = bench.targets.room_lx / 3.14159265 * (150 + 250 + 90);
    const double middle = white * 0.5 * (board.white + board.black);
    std::size_t marker = 0;
    for (int row = 0; row < 6; ++row) {
        for (int column = 0; column < 8; ++column) {
            const glm::dvec2 corner = glm::dvec2(column, row) * board.square_m;
            const double center =
                bright(picture, projected_px(bench, corner + 0.04 * board.square_m));
            if ((row + column) % 2 == 0) {
                EXPECT_LT(center, middle) << column << " " << row;
                continue;
            }
            EXPECT_GT(center, middle) << column << " " << row;
            unsigned bits = 0;
            for (int k = 0; k < 16; ++k) {
                const int bit_row = k / 4;
                const glm::dvec2 bit(k % 4 + 1.5, bit_row + 1.5);
                const glm::dvec2 at =
                    corner + 0.5 * (board.square_m - board.marker_m) + bit * board.marker_m / 6.0;
                bits = 2 * bits + (bright(picture, projected_px(bench, at)) > middle ? 1U : 0U);
            }
            EXPECT_EQ(bits, kMarkers[marker]) << "marker " << marker;
            ++marker;
        }
    }
    EXPECT_EQ(marker, kMarkers.size());
}

// How far the picture is from symmetric at d about a center, and how that changes with the center.
struct Asymmetry {
    double value = 0.0;
    glm::dvec2 slope{0.0};
};

Asymmetry asymmetry(const std::vector<float>& picture, glm::dvec2 center, glm::dvec2 d) {
    const auto value = [&](glm::dvec2 c) {
        return bright(picture, c + d) - bright(picture, c - d);
    };
    constexpr double kStep = 0.05;
    const glm::dvec2 x(kStep, 0), y(0, kStep);
    return {value(center), glm::dvec2(value(center + x) - value(center - x),
                                      value(center + y) - value(center - y)) /
                               (2 * kStep)};
}

// Around a corner of four squares the picture is symmetric under half a turn: the point about which
// it is most so, by Gauss and Newton.
glm::dvec2 symmetry_center(const std::vector<float>& picture, glm::dvec2 start_px) {
    glm::dvec2 center = start_px;
    for (int step = 0; step < 10; ++step) {
        glm::dmat2 normal(0.0);
        glm::dvec2 right(0.0);
        for (double y = -2.0; y <= 2.01; y += 0.5) {
            for (double x = -2.0; x <= 2.01; x += 0.5) {
                const Asymmetry at = asymmetry(picture, center, {x, y});
                normal += glm::outerProduct(at.slope, at.slope);
                right -= at.slope * at.value;
            }
        }
        center += glm::inverse(normal) * right;
    }
    return center;
}

TEST(BenchTarget, CornersLieWhereTheyAreProjected) {
    const Bench bench = target_bench();
    const std::vector<float> picture = board_picture(bench);
    double worst = 0.0;
    glm::dvec2 sum(0.0);
    for (int row = 1; row < 6; ++row) {
        for (int column = 1; column < 8; ++column) {
            const glm::dvec2 truth =
                projected_px(bench, glm::dvec2(column, row) * bench.targets.board.square_m);
            const glm::dvec2 error =
                symmetry_center(picture, truth + glm::dvec2(0.2, -0.15)) - truth;
            worst = std::max(worst, glm::length(error));
            sum += error / 35.0;
        }
    }
    // Linear interpolation between pixels and perspective within +-2 px leave hundredths of a
    // pixel; a shift by half of a sample (1/8 px) or more would show in the mean.
    EXPECT_LT(worst, 0.08);
    EXPECT_LT(glm::length(sum), 0.02);
    std::cout << "worst corner " << worst << " px, mean " << sum.x << " " << sum.y << " px\n";
}

TEST(BenchTarget, BackSideAndHandsAreSeen) {
    Bench bench = target_bench();
    const std::vector<float> front = board_picture(bench);
    bench.targets.hand_sigma_deg = 2.0;
    EXPECT_NE(front, board_picture(bench));
    bench.camera.bench_from_camera.rotation = glm::dmat3(1.0);
    bench.camera.bench_from_camera.translation_m.z = -0.6;
    EXPECT_EQ(test::mean_of(board_picture(bench)), 0.0);
}

}  // namespace
}  // namespace nearfield::sample_data
