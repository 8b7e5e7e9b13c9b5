// SPDX-License-Identifier: Apache-2.0
#include "calibrate/targets.h"

#include "calibrate/corner_fit.h"
#include "calibrate/dictionaries.h"
#include "calibrate/gray_picture.h"
#include "formats/files/error.h"

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>

namespace nearfield::calibrate {
namespace {

// OpenCV's cornerSubPix counts from the first pixel's center, we from its corner. Everything here
// is OpenCV's until it comes through this function.
Corner corner_from_opencv(const capture::BoardPlan& board, int id, cv::Point2f at) {
    return {id, corner_board_m(board, id), glm::dvec2(at.x, at.y) + 0.5};
}

void refine(const cv::Mat& gray, std::vector<cv::Point2f>& corners, int half_window_px) {
    const cv::TermCriteria done(cv::TermCriteria::EPS + cv::TermCriteria::MAX_ITER, 60, 1e-4);
    cv::cornerSubPix(gray, corners, {half_window_px, half_window_px}, {-1, -1}, done);
}

// The board around a corner as an affine picture, from the corners beside it: three at least that
// are not in line.
std::optional<glm::dmat2> px_from_squares(const capture::BoardPlan& board,
                                          const std::vector<int>& ids,
                                          const std::vector<cv::Point2f>& corners,
                                          std::size_t middle) {
    glm::dmat2 squares2(0.0), px_squares(0.0);  // sums of outer products
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const glm::dvec2 apart =
            (corner_board_m(board, ids[i]) - corner_board_m(board, ids[middle])) / board.square_m;
        if (glm::length(apart) > 1.5)
            continue;
        const cv::Point2f px = corners[i] - corners[middle];
        squares2 += glm::outerProduct(apart, apart);
        px_squares += glm::outerProduct(glm::dvec2(px.x, px.y), apart);
    }
    if (glm::determinant(squares2) < 0.5)
        return std::nullopt;
    return px_squares * glm::inverse(squares2);
}

// Where a corner cannot be fitted it stays.
void fit_corners(const cv::Mat& values,
                 const capture::BoardPlan& board,
                 const std::vector<int>& ids,
                 std::vector<cv::Point2f>& corners) {
    const std::vector<cv::Point2f> starts = corners;
    const double clear = 0.5 * (1.0 - board.marker_m / board.square_m);  // of a chessboard: all
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const auto local = px_from_squares(board, ids, starts, i);
        if (!local)
            continue;
        const auto found = fit_corner(values, {{starts[i].x, starts[i].y}, *local, clear});
        if (found)
            corners[i] = cv::Point2f(static_cast<float>(found->x), static_cast<float>(found->y));
    }
}

std::vector<Corner> find_chessboard(const GrayPicture& picture, const capture::BoardPlan& board) {
    const cv::Size inner(board.squares.x - 1, board.squares.y - 1);
    std::vector<cv::Point2f> found;
    if (!cv::findChessboardCorners(picture.stretched, inner, found,
                                   cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
        return {};
    constexpr int kHalfWindow_px = 5;
    refine(picture.values, found, kHalfWindow_px);
    std::vector<int> ids(found.size());
    std::iota(ids.begin(), ids.end(), 0);
    fit_corners(picture.values, board, ids, found);
    std::vector<Corner> corners;
    for (std::size_t i = 0; i < found.size(); ++i)
        corners.push_back(corner_from_opencv(board, ids[i], found[i]));
    return corners;
}

struct Markers {
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids;
};

// Small pictures are enlarged first: bits of a marker need some pixels each.
Markers find_markers(const cv::Mat& picture, const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
    constexpr double kGoodWidth_px = 1500.0;
    const int factor =
        std::clamp(static_cast<int>(std::lround(kGoodWidth_px / picture.cols)), 1, 3);
    cv::Mat larger = picture;
    if (factor > 1)
        cv::resize(picture, larger, {}, factor, factor, cv::INTER_CUBIC);
    Markers markers;
    cv::aruco::detectMarkers(larger, dictionary, markers.corners, markers.ids);
    const cv::Point2f half_px(0.5F, 0.5F);
    for (std::vector<cv::Point2f>& marker : markers.corners) {
        for (cv::Point2f& corner : marker)
            corner = (corner + half_px) / static_cast<float>(factor) - half_px;
    }
    return markers;
}

// Pixels between a corner and the markers beside it, which its window must not reach: least over
// the corners, by the distance of neighbors.
double clear_of_markers_px(const capture::BoardPlan& board,
                           const std::vector<int>& ids,
                           const std::vector<cv::Point2f>& corners) {
    double square_px = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < ids.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const glm::dvec2 apart =
                (corner_board_m(board, ids[i]) - corner_board_m(board, ids[j])) / board.square_m;
            const double squares = glm::length(apart);
            if (squares < 1.5)
                square_px = std::min(square_px, cv::norm(corners[i] - corners[j]) / squares);
        }
    }
    return square_px * 0.5 * (1.0 - board.marker_m / board.square_m);
}

std::vector<Corner> find_charuco(const GrayPicture& picture, const capture::BoardPlan& board) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(opencv_dictionary(board.dictionary));
    const auto layout = cv::aruco::CharucoBoard::create(
        board.squares.x, board.squares.y, static_cast<float>(board.square_m),
        static_cast<float>(board.marker_m), dictionary);
    const Markers markers = find_markers(picture.stretched, dictionary);
    if (markers.ids.empty())
        return {};
    std::vector<cv::Point2f> found;
    std::vector<int> ids;
    constexpr int kLeastMarkers = 1;  // beside a corner
    cv::aruco::interpolateCornersCharuco(markers.corners, markers.ids, picture.stretched, layout,
                                         found, ids, cv::noArray(), cv::noArray(), kLeastMarkers);
    if (found.empty())
        return {};
    // This function of 4.6 adds the half pixel itself, and stops refining within 0.1 px.
    for (cv::Point2f& corner : found)
        corner -= cv::Point2f(0.5F, 0.5F);
    // A corner beside one marker alone may be two pixels off: a larger window first. Windows and
    // blur as measured on boards whose corners are known (docs/calibration_geometry.md).
    constexpr int kLeastHalf_px = 2, kMostHalf_px = 7;
    constexpr double kBlur_px = 0.7;
    cv::Mat smooth;
    cv::GaussianBlur(picture.values, smooth, {0, 0}, kBlur_px);
    const double clear_px = std::clamp(clear_of_markers_px(board, ids, found),
                                       double(kLeastHalf_px), double(kMostHalf_px));
    refine(smooth, found, static_cast<int>(clear_px) + 1);
    refine(smooth, found, static_cast<int>(clear_px));
    fit_corners(picture.values, board, ids, found);
    std::vector<Corner> corners;
    for (std::size_t i = 0; i < found.size(); ++i)
        corners.push_back(corner_from_opencv(board, ids[i], found[i]));
    std::sort(corners.begin(), corners.end(),
              [](const Corner& a, const Corner& b) { return a.id < b.id; });
    return corners;
}

}  // namespace

glm::dvec2 corner_board_m(const capture::BoardPlan& board, int id) {
    const int columns = board.squares.x - 1;
    return glm::dvec2(id % columns + 1, id / columns + 1) * board.square_m;
}

std::vector<Corner> find_board(const capture::Frame& frame,
                               const std::string& mosaic,
                               const capture::BoardPlan& board) {
    const GrayPicture picture = gray_picture(frame, mosaic);
    return board.kind == capture::BoardKind::Chessboard ? find_chessboard(picture, board)
                                                        : find_charuco(picture, board);
}

}  // namespace nearfield::calibrate
