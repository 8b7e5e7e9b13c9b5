// SPDX-License-Identifier: Apache-2.0
#include "calibrate/corner_fit.h"

#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace nearfield::calibrate {
namespace {

// Longer arms bend with the lens (0.03 px at 14 px, by the sample benches' distortion).
constexpr double kLongestArm_px = 8.0, kLongestArm_squares = 0.42;
// What the blur lets reach over from a marker's edge.
constexpr double kBlurReach_px = 1.5;
constexpr double kLeastBand_px = 1.5;

struct Pixel {
    glm::dvec2 from_start_px{0.0};
    double value = 0.0;
};

enum Parameter {
    kX,
    kY,
    kAngle1,
    kAngle2,
    kBlur,
    kSlopeX,
    kSlopeY,
    kMiddle,
    kContrast,
    kParameters
};

template <typename T>
T corner_value(const T* p, glm::dvec2 at) {
    using std::cos, std::erf, std::sin;
    const T dx = at.x - p[kX], dy = at.y - p[kY];
    const auto edge = [&](const T& angle) {
        return erf((cos(angle) * dy - sin(angle) * dx) / (std::numbers::sqrt2 * p[kBlur]));
    };
    return (1.0 + p[kSlopeX] * dx + p[kSlopeY] * dy) *
           (p[kMiddle] + p[kContrast] * edge(p[kAngle1]) * edge(p[kAngle2]));
}

struct CornerResiduals {
    const std::vector<Pixel>* pixels;

    // NOLINTNEXTLINE(readability-identifier-naming): Ceres calls it so.
    int NumResiduals() const { return static_cast<int>(pixels->size()); }
    template <typename T>
    bool operator()(const T* parameters, T* residuals) const {
        for (std::size_t i = 0; i < pixels->size(); ++i) {
            const Pixel& pixel = (*pixels)[i];
            residuals[i] = corner_value(parameters, pixel.from_start_px) - pixel.value;
        }
        return true;
    }
};

using Numbers = Eigen::Matrix<double, kParameters, 1>;

// Pixels beside the edges: nearer to one of them than the markers, and not too far along it.
std::vector<Pixel> pixels_beside_edges(const cv::Mat& values, const CornerWindow& window) {
    const glm::dmat2 squares_from_px = glm::inverse(window.px_from_squares);
    const glm::dvec2 square_px(glm::length(window.px_from_squares[0]),
                               glm::length(window.px_from_squares[1]));
    // An edge's distance in the picture is less than along the other edge where the board is
    // oblique.
    const double sine =
        std::abs(glm::determinant(window.px_from_squares)) / (square_px.x * square_px.y);
    const glm::dvec2 apart_px = square_px * sine;
    const glm::dvec2 band_px =
        glm::max(window.clear_squares * apart_px - kBlurReach_px, glm::dvec2(kLeastBand_px));
    const glm::dvec2 arm_px = glm::min(kLongestArm_squares * apart_px, glm::dvec2(kLongestArm_px));
    const glm::ivec2 middle(glm::round(window.start_px));
    const int reach = static_cast<int>(std::ceil(1.5 * kLongestArm_px));
    std::vector<Pixel> pixels;
    for (int y = std::max(middle.y - reach, 0); y <= std::min(middle.y + reach, values.rows - 1);
         ++y) {
        for (int x = std::max(middle.x - reach, 0);
             x <= std::min(middle.x + reach, values.cols - 1); ++x) {
            const glm::dvec2 from_start = glm::dvec2(x, y) - window.start_px;
            const glm::dvec2 off = glm::abs(squares_from_px * from_start) * apart_px;
            const bool is_beside = off.x < band_px.x || off.y < band_px.y;
            if (is_beside && off.x < arm_px.x && off.y < arm_px.y)
                pixels.push_back({from_start, double(values.at<float>(y, x))});
        }
    }
    return pixels;
}

Numbers first_guess(const std::vector<Pixel>& pixels, const CornerWindow& window) {
    const glm::dvec2 along1 = window.px_from_squares[0], along2 = window.px_from_squares[1];
    Numbers guess = Numbers::Zero();
    guess[kAngle1] = std::atan2(along1.y, along1.x);
    guess[kAngle2] = std::atan2(along2.y, along2.x);
    guess[kBlur] = 0.8;
    // Middle and contrast by a line through value against the blurred sign.
    guess[kContrast] = 1.0;
    double sum_s = 0.0, sum_v = 0.0, sum_ss = 0.0, sum_sv = 0.0;
    for (const Pixel& pixel : pixels) {
        const double sign = corner_value(guess.data(), pixel.from_start_px);
        sum_s += sign;
        sum_v += pixel.value;
        sum_ss += sign * sign;
        sum_sv += sign * pixel.value;
    }
    const double count = static_cast<double>(pixels.size());
    guess[kContrast] = (count * sum_sv - sum_s * sum_v) / (count * sum_ss - sum_s * sum_s);
    guess[kMiddle] = (sum_v - guess[kContrast] * sum_s) / count;
    return guess;
}

bool solve(const std::vector<Pixel>& pixels, Numbers& numbers) {
    const CornerResiduals residuals{&pixels};
    using Function =
        ceres::TinySolverAutoDiffFunction<CornerResiduals, Eigen::Dynamic, kParameters>;
    const Function function(residuals);
    ceres::TinySolver<Function> solver;
    solver.options.max_num_iterations = 30;
    solver.Solve(function, &numbers);
    return numbers.allFinite();
}

std::vector<double> misses(const std::vector<Pixel>& pixels, const Numbers& numbers) {
    std::vector<double> missed;
    missed.reserve(pixels.size());
    for (const Pixel& pixel : pixels)
        missed.push_back(std::abs(corner_value(numbers.data(), pixel.from_start_px) - pixel.value));
    return missed;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Hot pixels and dust: further off than 5 sigma by the median.
std::vector<Pixel> without_outliers(const std::vector<Pixel>& pixels, const Numbers& numbers) {
    const std::vector<double> missed = misses(pixels, numbers);
    const double limit = 5.0 * 1.4826 * median(missed);
    std::vector<Pixel> kept;
    kept.reserve(pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (missed[i] <= limit)
            kept.push_back(pixels[i]);
    }
    return kept;
}

bool is_corner(const std::vector<Pixel>& pixels, const Numbers& numbers) {
    constexpr double kMostMove_px = 2.0, kLeastBlur_px = 0.1, kMostBlur_px = 4.0, kMostMiss = 0.25;
    const glm::dvec2 moved(numbers[kX], numbers[kY]);
    return glm::length(moved) < kMostMove_px && numbers[kBlur] > kLeastBlur_px &&
           numbers[kBlur] < kMostBlur_px &&
           median(misses(pixels, numbers)) < kMostMiss * std::abs(numbers[kContrast]);
}

}  // namespace

std::optional<glm::dvec2> fit_corner(const cv::Mat& values, const CornerWindow& window) {
    constexpr std::size_t kLeastPixels = std::size_t{3} * kParameters;
    std::vector<Pixel> pixels = pixels_beside_edges(values, window);
    if (pixels.size() < kLeastPixels)
        return std::nullopt;
    Numbers numbers = first_guess(pixels, window);
    if (!numbers.allFinite() || !solve(pixels, numbers))
        return std::nullopt;
    pixels = without_outliers(pixels, numbers);
    if (pixels.size() < kLeastPixels || !solve(pixels, numbers) || !is_corner(pixels, numbers))
        return std::nullopt;
    // Blur carries light from the bright side of a slope to the dark: edges seem to lie blur^2 x
    // slope further there.
    const glm::dvec2 carried =
        numbers[kBlur] * numbers[kBlur] * glm::dvec2(numbers[kSlopeX], numbers[kSlopeY]);
    return window.start_px + glm::dvec2(numbers[kX], numbers[kY]) + carried;
}

}  // namespace nearfield::calibrate
