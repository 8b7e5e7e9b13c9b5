// SPDX-License-Identifier: Apache-2.0
#include "app/cutoff_line.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

constexpr double kLowest_deg = -3.0, kHighest_deg = 4.0;
constexpr double kStep_deg = 0.05;
constexpr std::size_t kSlopeSteps = 2;  // 0.1 degrees, the step of ECE R 112's gradient

double angle_deg(double index) {
    return kLowest_deg + index * kStep_deg;
}

double tangent_at(double angle_deg) {
    return std::tan(glm::radians(angle_deg));
}

// Light at every step upwards; empty where there is none.
std::vector<double> scanned(const BeamScan& scan, double tangent_x) {
    const int count = static_cast<int>(std::lround((kHighest_deg - kLowest_deg) / kStep_deg)) + 1;
    std::vector<double> light;
    light.reserve(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k)
        light.push_back(scan(tangent_x, tangent_at(angle_deg(k))));
    if (!(*std::max_element(light.begin(), light.end()) > 0.0))
        light.clear();
    return light;
}

// The place of the largest value, between the steps by a parabola.
double peak_index(const std::vector<double>& value) {
    const auto best =
        static_cast<std::size_t>(std::max_element(value.begin(), value.end()) - value.begin());
    if (best == 0 || best + 1 >= value.size())
        return static_cast<double>(best);
    const double before = value[best - 1], after = value[best + 1];
    const double bend = before - 2 * value[best] + after;
    return static_cast<double>(best) + (bend < 0 ? 0.5 * (before - after) / bend : 0);
}

// a + b x through log E between two angles, by least squares; none where there is no light.
std::optional<glm::dvec2> log_line_through(const std::vector<double>& light,
                                           double from_deg,
                                           double to_deg) {
    double count = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t k = 0; k < light.size(); ++k) {
        const double at_deg = angle_deg(static_cast<double>(k));
        if (at_deg < from_deg || at_deg > to_deg)
            continue;
        if (!(light[k] > 0.0))
            return std::nullopt;
        const double log_light = std::log(light[k]);
        count += 1;
        x += at_deg;
        y += log_light;
        xx += at_deg * at_deg;
        xy += at_deg * log_light;
    }
    const double slope = (count * xy - x * y) / (count * xx - x * x);
    return glm::dvec2((y - slope * x) / count, slope);
}

// Of the scan, taken as straight between its steps.
double integral(const std::vector<double>& light, double from_deg, double to_deg) {
    const auto at = [&](double deg) {
        const double index =
            std::clamp((deg - kLowest_deg) / kStep_deg, 0.0, double(light.size()) - 1.001);
        const auto k = static_cast<std::size_t>(index);
        return glm::mix(light[k], light[k + 1], index - static_cast<double>(k));
    };
    constexpr int kParts = 400;
    const double step_deg = (to_deg - from_deg) / kParts;
    double sum = 0;
    for (int k = 0; k < kParts; ++k)
        sum += step_deg * at(from_deg + (k + 0.5) * step_deg);
    return sum;
}

// The angle up to which a beam exp(a + b x) has given `area` from `from_deg` on.
std::optional<double> edge_of_area(glm::dvec2 log_line, double from_deg, double area) {
    const double share = area / std::exp(log_line.x + log_line.y * from_deg);
    const double x = log_line.y * share;  // log(1 + x) / x, which has a limit at 0
    if (!(x > -1.0))
        return std::nullopt;
    return from_deg + share * (std::abs(x) > 1e-12 ? std::log1p(x) / x : 1.0);
}

}  // namespace

std::optional<double> gradient_tangent(const BeamScan& scan, double tangent_x) {
    const std::vector<double> light = scanned(scan, tangent_x);
    if (light.empty())
        return std::nullopt;
    // Above the beam there may be no light at all, whose logarithm says nothing.
    constexpr double kDarkest = 1e-4;
    const double dark = kDarkest * *std::max_element(light.begin(), light.end());
    std::vector<double> slope;
    for (std::size_t k = 0; k + kSlopeSteps < light.size(); ++k)
        slope.push_back(std::log((light[k] + dark) / (light[k + kSlopeSteps] + dark)));
    return tangent_at(angle_deg(peak_index(slope) + 0.5 * kSlopeSteps));
}

std::optional<double> edge_tangent(const BeamScan& scan, double tangent_x) {
    constexpr double kFar_deg = 1.2, kNear_deg = 0.6;  // below the edge: the beam
    constexpr double kAbove_deg = 0.8;
    constexpr int kRounds = 5;  // the beam's part hangs on the edge
    const std::vector<double> light = scanned(scan, tangent_x);
    if (light.empty())
        return std::nullopt;
    std::vector<double> fall;
    for (std::size_t k = 0; k + kSlopeSteps < light.size(); ++k)
        fall.push_back(light[k] - light[k + kSlopeSteps]);
    double edge_deg = angle_deg(peak_index(fall) + 0.5 * kSlopeSteps);
    for (int round = 0; round < kRounds; ++round) {
        const double from_deg = edge_deg - kFar_deg;
        const auto line = log_line_through(light, from_deg, edge_deg - kNear_deg);
        if (!line)
            return std::nullopt;
        const auto edge =
            edge_of_area(*line, from_deg, integral(light, from_deg, edge_deg + kAbove_deg));
        if (!edge)
            return std::nullopt;
        edge_deg = std::clamp(*edge, kLowest_deg + kFar_deg, kHighest_deg - kAbove_deg);
    }
    return tangent_at(edge_deg);
}

std::vector<double> cutoff_places() {
    // +x is the driver's left, where the line is level; it rises on the right up to 0.18.
    return {0.25, 0.2, 0.15, 0.1, 0.06, -0.04, -0.06, -0.08, -0.1, -0.12, -0.14};
}

}  // namespace nearfield::app
