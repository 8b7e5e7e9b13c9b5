// SPDX-License-Identifier: Apache-2.0
// Photographs of real boards, where they are at hand: OpenCV's sample of a chessboard (13 views)
// and the ChArUco board of its tutorial.
#include "calibrate/geometry.h"
#include "calibrate/targets.h"

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <string>

namespace nearfield::calibrate {
namespace {

std::filesystem::path photographs(const std::string& name) {
    return std::filesystem::path(NEARFIELD_SOURCE_DIR) / "../shared/data/capture" / name;
}

capture::Frame photograph(const std::filesystem::path& path) {
    const cv::Mat gray = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
    capture::Frame frame{{gray.cols, gray.rows}, 1, 8, {}};
    for (int y = 0; y < gray.rows; ++y) {
        for (int x = 0; x < gray.cols; ++x)
            frame.values.push_back(gray.at<unsigned char>(y, x));
    }
    return frame;
}

Observations chessboard_views(const std::filesystem::path& folder) {
    const capture::BoardPlan board{capture::BoardKind::Chessboard, {10, 7}, 0.025, 0.0, {}};
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".jpg")
            files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    Observations seen;
    for (const std::filesystem::path& file : files) {
        const capture::Frame frame = photograph(file);
        seen.size_px = frame.size_px;
        seen.boards.push_back({static_cast<int>(seen.boards.size()), capture::TargetPlane::Free,
                               file.filename().string(), find_board(frame, "mono", board)});
    }
    return seen;
}

// OpenCV's own calibration of the same corners: fx fy cx cy k1 k2 p1 p2 k3, and its RMS.
struct OpenCvLens {
    std::vector<double> numbers;
    double rms_px = 0;
};

OpenCvLens opencv_lens(const Observations& seen, bool has_square_pixels) {
    std::vector<std::vector<cv::Point3f>> board;
    std::vector<std::vector<cv::Point2f>> picture;
    for (const BoardView& view : seen.boards) {
        board.emplace_back();
        picture.emplace_back();
        for (const Corner& corner : view.corners) {
            board.back().emplace_back(float(corner.board_m.x), float(corner.board_m.y), 0.0F);
            picture.back().emplace_back(float(corner.at_px.x - 0.5), float(corner.at_px.y - 0.5));
        }
    }
    cv::Mat matrix = cv::Mat::eye(3, 3, CV_64F), distortion;
    std::vector<cv::Mat> turns, shifts;
    const int flags = has_square_pixels ? cv::CALIB_FIX_ASPECT_RATIO : 0;
    OpenCvLens lens;
    lens.rms_px = cv::calibrateCamera(
        board, picture, {seen.size_px.x, seen.size_px.y}, matrix, distortion, turns, shifts, flags,
        {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 200, 1e-12});
    lens.numbers = {matrix.at<double>(0, 0), matrix.at<double>(1, 1), matrix.at<double>(0, 2) + 0.5,
                    matrix.at<double>(1, 2) + 0.5};
    for (int i = 0; i < 5; ++i)
        lens.numbers.push_back(distortion.at<double>(i));
    return lens;
}

TEST(Photographs, ChessboardGivesTheLensThatOpenCvGives) {
    const std::filesystem::path folder = photographs("chessboard");
    if (!std::filesystem::exists(folder))
        GTEST_SKIP() << "no photographs in " << folder;
    const Observations seen = chessboard_views(folder);
    ASSERT_EQ(seen.boards.size(), 13U);
    for (const BoardView& view : seen.boards)
        EXPECT_EQ(view.corners.size(), 54U) << view.name;
    for (const bool has_square_pixels : {false, true}) {
        GeometryOptions options;
        options.with_planes = false;
        options.has_square_pixels = has_square_pixels;
        const Geometry found = calibrate_geometry(seen, options);
        options.outlier_sigmas = 1e9;
        const Geometry whole = calibrate_geometry(seen, options);
        const OpenCvLens opencv = opencv_lens(seen, has_square_pixels);
        EXPECT_LE(found.rms_px, 0.20);
        // The same corners, the same model, the same sum of squares: the same optimum. Corners are
        // floats there, its iteration stops earlier.
        EXPECT_NEAR(whole.rms_px, opencv.rms_px, 1e-4);
        for (std::size_t i = 0; i < opencv.numbers.size(); ++i) {
            const rig::Parameter& ours = whole.parameters[i];
            EXPECT_LT(std::abs(ours.value - opencv.numbers[i]), 0.1 * ours.sigma) << ours.name;
            EXPECT_LT(std::abs(found.parameters[i].value - opencv.numbers[i]), 2.0 * ours.sigma)
                << ours.name;
            std::cout << ours.name << " " << found.parameters[i].value << " +- "
                      << found.parameters[i].sigma << ", with outliers " << ours.value
                      << ", OpenCV " << opencv.numbers[i] << "\n";
        }
        std::cout << "RMS " << found.rms_px << " px (" << found.outliers.size()
                  << " outliers), with outliers " << whole.rms_px << " px, OpenCV " << opencv.rms_px
                  << " px; held out " << found.held_out->rms_px << " px; halves "
                  << found.halves->difference_rms_px << " of " << found.halves->predicted_rms_px
                  << " px; bend " << found.bend->significance_sigma << " sigma\n";
    }
}

TEST(Photographs, CharucoOfTheTutorialIsFound) {
    const std::filesystem::path file = photographs("aruco_photos") / "choriginal.jpg";
    if (!std::filesystem::exists(file))
        GTEST_SKIP() << "no photograph " << file;
    const capture::BoardPlan board{capture::BoardKind::Charuco, {5, 7}, 0.04, 0.02, "6x6_250"};
    const std::vector<Corner> corners = find_board(photograph(file), "mono", board);
    EXPECT_EQ(corners.size(), 24U);
}

}  // namespace
}  // namespace nearfield::calibrate
