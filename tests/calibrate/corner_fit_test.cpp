// SPDX-License-Identifier: Apache-2.0
// Corners drawn by brute force, so that their places are known: the light of every pixel is a sum
// over points of its area and of the lens' blur.
#include "calibrate/corner_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <vector>

namespace nearfield::calibrate {
namespace {

struct Drawn {
    glm::dvec2 corner_px{15.0};
    double angle1_rad = 0.3, angle2_rad = 0.3 + std::numbers::pi / 2;
    double blur_px = 0.7;
    double slope = 0.0;  // of the light along x, relative, per pixel
    double dark = 10.0, bright = 200.0;

    glm::dmat2 px_from_squares(double square_px) const {
        return {square_px * glm::dvec2(std::cos(angle1_rad), std::sin(angle1_rad)),
                square_px * glm::dvec2(std::cos(angle2_rad), std::sin(angle2_rad))};
    }
    double light(glm::dvec2 at) const {
        const glm::dvec2 d = at - corner_px;
        const double side1 = std::cos(angle1_rad) * d.y - std::sin(angle1_rad) * d.x;
        const double side2 = std::cos(angle2_rad) * d.y - std::sin(angle2_rad) * d.x;
        return (side1 * side2 > 0.0 ? bright : dark) * (1.0 + slope * d.x);
    }
};

constexpr int kPoints = 10;  // a side of the pixel, and of the blur

// Where the middles of a normal distribution's equal parts lie.
std::vector<double> blur_px(double sigma_px) {
    std::vector<double> quantile;
    quantile.reserve(kPoints);
    for (int i = 0; i < kPoints; ++i) {
        const double share = (i + 0.5) / kPoints;
        double low = -6.0, high = 6.0;
        for (int step = 0; step < 60; ++step) {
            const double middle = 0.5 * (low + high);
            (0.5 * std::erfc(-middle / std::numbers::sqrt2) < share ? low : high) = middle;
        }
        quantile.push_back(sigma_px * low);
    }
    return quantile;
}

double pixel_value(const Drawn& drawn, const std::vector<double>& blur, glm::dvec2 center_px) {
    double sum = 0.0;
    for (int part = 0; part < kPoints * kPoints; ++part) {
        const int row = part / kPoints;
        const glm::dvec2 inside = (glm::dvec2(part % kPoints, row) + 0.5) / double(kPoints) - 0.5;
        for (const double x : blur) {
            for (const double y : blur)
                sum += drawn.light(center_px + inside + glm::dvec2(x, y));
        }
    }
    return sum / std::pow(kPoints, 4);
}

cv::Mat picture(const Drawn& drawn) {
    const std::vector<double> blur = blur_px(drawn.blur_px);
    cv::Mat values(31, 31, CV_32F);
    for (int y = 0; y < values.rows; ++y) {
        for (int x = 0; x < values.cols; ++x)
            values.at<float>(y, x) = static_cast<float>(pixel_value(drawn, blur, {x, y}));
    }
    return values;
}

CornerWindow window(const Drawn& drawn, glm::dvec2 start_px, double square_px = 30.0) {
    return {start_px, drawn.px_from_squares(square_px), 0.5};
}

double error_px(const Drawn& drawn, const std::optional<glm::dvec2>& found) {
    return found ? glm::length(*found - drawn.corner_px) : 1e9;
}

TEST(CornerFit, HasNoBiasWhereverInItsPixelTheCornerLies) {
    double worst_px = 0.0;
    for (int phase = 0; phase < 16; ++phase) {
        Drawn drawn;
        const int row = phase / 4;
        drawn.corner_px = glm::dvec2(15.0) + glm::dvec2(phase % 4, row) / 4.0;
        drawn.angle1_rad = 0.05 + 0.09 * phase;
        drawn.angle2_rad = drawn.angle1_rad + 1.2;  // an oblique view
        const auto found = fit_corner(picture(drawn), window(drawn, glm::dvec2(15.4, 15.3)));
        worst_px = std::max(worst_px, error_px(drawn, found));
    }
    std::cout << "worst of 16 phases: " << worst_px << " px\n";
    EXPECT_LT(worst_px, 0.005);
}

TEST(CornerFit, LightThatSlopesDoesNotShiftTheCorner) {
    Drawn drawn;
    drawn.slope = 0.03;
    const auto found = fit_corner(picture(drawn), window(drawn, {15.5, 14.6}));
    EXPECT_LT(error_px(drawn, found), 0.003);  // 0.016 if blur did not count
}

TEST(CornerFit, AHotPixelIsLeftOut) {
    const Drawn drawn;
    cv::Mat values = picture(drawn);
    values.at<float>(16, 18) = 4000.0F;
    EXPECT_LT(error_px(drawn, fit_corner(values, window(drawn, {15.2, 15.2}))), 0.01);
}

TEST(CornerFit, MarkersBesideTheEdgesDoNotMatter) {
    Drawn drawn;
    drawn.blur_px = 0.5;
    const CornerWindow clear{{15.2, 14.9}, drawn.px_from_squares(30.0), 0.15};
    cv::Mat values = picture(drawn);
    const glm::dmat2 squares_from_px = glm::inverse(clear.px_from_squares);
    for (int y = 0; y < values.rows; ++y) {
        for (int x = 0; x < values.cols; ++x) {
            const glm::dvec2 off = squares_from_px * (glm::dvec2(x, y) - drawn.corner_px);
            if (off.x > 0.15 && off.y > 0.15)  // one marker alone: nothing that symmetry hides
                values.at<float>(y, x) = 100.0F;
        }
    }
    EXPECT_LT(error_px(drawn, fit_corner(values, clear)), 0.005);
    // Not by luck, nor as outliers: none of its pixels is looked at.
    EXPECT_EQ(fit_corner(values, clear), fit_corner(picture(drawn), clear));
}

TEST(CornerFit, WhatIsNoCornerIsNotFound) {
    const Drawn drawn;
    EXPECT_FALSE(fit_corner(cv::Mat(31, 31, CV_32F, cv::Scalar(100)), window(drawn, {15, 15})));
    cv::Mat noise(31, 31, CV_32F);
    std::mt19937 random(1);
    std::normal_distribution<float> normal(100.0F, 20.0F);
    for (float& value : cv::Mat_<float>(noise))
        value = normal(random);
    EXPECT_FALSE(fit_corner(noise, window(drawn, {15, 15})));
    const cv::Mat values = picture(drawn);
    EXPECT_FALSE(fit_corner(values, window(drawn, {-40, 15})));    // outside of the picture
    EXPECT_FALSE(fit_corner(values, window(drawn, {15, 15}, 3)));  // three pixels a square
    EXPECT_FALSE(fit_corner(values, window(drawn, {20, 20})));     // another place
}

}  // namespace
}  // namespace nearfield::calibrate
