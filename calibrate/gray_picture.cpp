// SPDX-License-Identifier: Apache-2.0
#include "calibrate/gray_picture.h"

#include "formats/files/error.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace nearfield::calibrate {
namespace {

// Levels below and above which a share of a picture's values lies.
struct Span {
    float low = 0, high = 1;

    float size() const { return high > low ? high - low : 1.0F; }
};

Span span_of(std::vector<float> values, double share) {
    const auto at = [&](double part) {
        const auto index = static_cast<std::ptrdiff_t>(part * double(values.size() - 1));
        std::nth_element(values.begin(), values.begin() + index, values.end());
        return values[static_cast<std::size_t>(index)];
    };
    const float low = at(share);
    return {low, at(1.0 - share)};
}

// The mean of a frame's channels.
cv::Mat mean_of_channels(const capture::Frame& frame) {
    cv::Mat gray(frame.size_px.y, frame.size_px.x, CV_32F);
    const auto channels = static_cast<std::size_t>(frame.channels);
    std::size_t at = 0;
    for (int y = 0; y < gray.rows; ++y) {
        for (int x = 0; x < gray.cols; ++x) {
            float sum = 0;
            for (std::size_t channel = 0; channel < channels; ++channel)
                sum += static_cast<float>(frame.values[at++]);
            gray.at<float>(y, x) = sum / static_cast<float>(channels);
        }
    }
    return gray;
}

// Scales each of the mosaic's four places to the same levels of dark and bright: a board is gray.
void even_mosaic(cv::Mat& gray) {
    std::array<Span, 4> spans;
    for (int place = 0; place < 4; ++place) {
        std::vector<float> values;
        for (int y = place / 2; y < gray.rows; y += 2) {
            for (int x = place % 2; x < gray.cols; x += 2)
                values.push_back(gray.at<float>(y, x));
        }
        spans[static_cast<std::size_t>(place)] = span_of(std::move(values), 0.05);
    }
    for (int y = 0; y < gray.rows; ++y) {
        for (int x = 0; x < gray.cols; ++x) {
            const Span& span = spans[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
            float& value = gray.at<float>(y, x);
            value = (value - span.low) / span.size();
        }
    }
}

}  // namespace

GrayPicture gray_picture(const capture::Frame& frame, const std::string& mosaic) {
    constexpr std::array<std::string_view, 4> kMosaics = {"rggb", "grbg", "gbrg", "bggr"};
    const bool is_mosaic = std::find(kMosaics.begin(), kMosaics.end(), mosaic) != kMosaics.end();
    if (!is_mosaic && mosaic != "mono" && mosaic != "rgb")
        throw Error{"cannot look for the board", "mosaic", "mono, rgb, rggb, grbg, gbrg or bggr",
                    "'" + mosaic + "'"};
    cv::Mat gray = mean_of_channels(frame);
    if (is_mosaic && frame.channels == 1)
        even_mosaic(gray);
    constexpr double kCutOff = 0.01;
    const Span span = span_of({gray.begin<float>(), gray.end<float>()}, kCutOff);
    GrayPicture picture;
    const double scale = 255.0 / std::max(double(span.high) - double(span.low), 1e-9);
    gray.convertTo(picture.values, CV_32F, scale, -scale * double(span.low));
    picture.values.convertTo(picture.stretched, CV_8U);
    return picture;
}

}  // namespace nearfield::calibrate
