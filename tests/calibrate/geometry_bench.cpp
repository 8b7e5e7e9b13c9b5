// SPDX-License-Identifier: Apache-2.0
// Times the bundle adjustment of 100 views of 500 corners against cv::calibrateCamera on the same
// corners. Prints; nothing to pass or fail.
#include "calibrate/geometry.h"
#include "tests/calibrate/simulated.h"

#include <opencv2/calib3d.hpp>

#include <chrono>
#include <cstddef>
#include <iostream>
#include <vector>

namespace {

using nearfield::calibrate::BoardView;
using nearfield::calibrate::Corner;
using nearfield::calibrate::Observations;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double opencv_rms_px(const Observations& seen) {
    std::vector<std::vector<cv::Point3f>> board(seen.boards.size());
    std::vector<std::vector<cv::Point2f>> picture(seen.boards.size());
    for (std::size_t view = 0; view < seen.boards.size(); ++view) {
        for (const Corner& corner : seen.boards[view].corners) {
            board[view].emplace_back(float(corner.board_m.x), float(corner.board_m.y), 0.0F);
            picture[view].emplace_back(float(corner.at_px.x - 0.5), float(corner.at_px.y - 0.5));
        }
    }
    cv::Mat matrix, distortion;
    std::vector<cv::Mat> turns, shifts;
    return cv::calibrateCamera(board, picture, {seen.size_px.x, seen.size_px.y}, matrix, distortion,
                               turns, shifts);
}

}  // namespace

int main() {
    namespace calibrate = nearfield::calibrate;
    namespace rig = nearfield::rig;
    namespace test = nearfield::test;
    test::SimulatedBench bench = test::simulated_bench(rig::LensModel::Brown5, 96, 0.0);
    bench.squares = {26, 21};
    bench.square_m = 0.009;
    const Observations seen = test::observed(bench, {1, 0.05, 0.02});
    std::size_t corners = 0;
    for (const BoardView& view : seen.boards)
        corners += view.corners.size();
    calibrate::GeometryOptions options;
    options.with_planes = false;
    options.with_validation = false;
    const calibrate::Geometry found = calibrate::calibrate_geometry(seen, options);
    std::cout << seen.boards.size() << " views, " << corners << " corners: " << found.time_s
              << " s, " << found.iterations << " iterations, RMS " << found.rms_px << " px\n";
    const auto start = std::chrono::steady_clock::now();
    const double rms_px = opencv_rms_px(seen);
    std::cout << "cv::calibrateCamera: " << seconds_since(start) << " s, RMS " << rms_px << " px\n";
    return 0;
}
