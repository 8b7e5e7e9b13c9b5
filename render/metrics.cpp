// SPDX-License-Identifier: Apache-2.0
#include "render/metrics.h"

#include "formats/files/error.h"

#include <fmt/format.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace nearfield::render {
namespace {

void check_sizes(std::size_t size, std::size_t reference_size) {
    if (size != reference_size)
        throw Error{"cannot compare", "metrics", fmt::format("{} values", reference_size),
                    fmt::format("{}", size)};
}

glm::dvec3 pixel(std::span<const float> rgb, std::size_t index) {
    return {rgb[3 * index], rgb[3 * index + 1], rgb[3 * index + 2]};
}

double luminance(glm::dvec3 rgb) {
    return glm::dot(rgb, glm::dvec3(0.2126, 0.7152, 0.0722));
}

// CIE 15:2004. Rec.709 primaries and white D65 (IEC 61966-2-1); rows sum to the white point.
glm::dvec3 lab_from_linear_rgb(glm::dvec3 rgb) {
    const glm::dvec3 x_row(0.4124, 0.3576, 0.1805), y_row(0.2126, 0.7152, 0.0722),
        z_row(0.0193, 0.1192, 0.9505);
    const auto f = [](double t) {
        constexpr double kDelta = 6.0 / 29.0;
        return t > kDelta * kDelta * kDelta ? std::cbrt(t)
                                            : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
    };
    const double x = f(glm::dot(x_row, rgb) / glm::dot(x_row, glm::dvec3(1.0)));
    const double y = f(glm::dot(y_row, rgb));
    const double z = f(glm::dot(z_row, rgb) / glm::dot(z_row, glm::dvec3(1.0)));
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

double percentile(const std::vector<double>& sorted, double share) {
    const auto rank =
        static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return sorted[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

RelativeError relative_error(std::span<const float> values, std::span<const float> reference) {
    constexpr double kFloor = 1e-3;
    check_sizes(values.size(), reference.size());
    RelativeError result;
    double largest = 0.0;
    for (const float value : reference)
        largest = std::max(largest, static_cast<double>(value));
    std::vector<double> errors;
    double squares = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto expected = static_cast<double>(reference[i]);
        if (!(expected > kFloor * largest))
            continue;
        const double error = static_cast<double>(values[i]) / expected - 1.0;
        errors.push_back(std::abs(error));
        squares += error * error;
        result.bias += error;
    }
    result.count = errors.size();
    if (errors.empty())
        return result;
    std::sort(errors.begin(), errors.end());
    result.rms = std::sqrt(squares / static_cast<double>(errors.size()));
    result.bias /= static_cast<double>(errors.size());
    result.p50 = percentile(errors, 0.50);
    result.p95 = percentile(errors, 0.95);
    result.largest = errors.back();
    return result;
}

double lab_difference(std::span<const float> rgb, std::span<const float> reference_rgb) {
    check_sizes(rgb.size(), reference_rgb.size());
    const std::size_t pixels = rgb.size() / 3;
    double mean = 0.0;
    for (std::size_t i = 0; i < pixels; ++i)
        mean += luminance(pixel(reference_rgb, i)) / static_cast<double>(pixels);
    if (!(mean > 0.0))
        return 0.0;
    double sum = 0.0;
    std::size_t lit = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        const glm::dvec3 expected = pixel(reference_rgb, i);
        if (!(luminance(expected) > 0.0))
            continue;
        const auto lab = [&](glm::dvec3 color) {
            return lab_from_linear_rgb(1.0 - glm::exp(-color / mean));
        };
        sum += glm::distance(lab(pixel(rgb, i)), lab(expected));
        ++lit;
    }
    return sum / static_cast<double>(lit);
}

}  // namespace nearfield::render
