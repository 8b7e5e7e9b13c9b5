// SPDX-License-Identifier: Apache-2.0
#include "app/cutoff_line.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

constexpr double kLowest_deg = -2.0, kHighest_deg = 4.0;
constexpr double kStep_deg = 0.05;
constexpr int kSlopeSteps = 2;  // 0.1 degrees, the step of ECE R 112's gradient

}  // namespace

std::optional<double> cutoff_tangent(const BeamScan& scan, double tangent_x) {
    const int count = static_cast<int>(std::lround((kHighest_deg - kLowest_deg) / kStep_deg)) + 1;
    const auto angle_deg = [&](double index) { return kLowest_deg + index * kStep_deg; };
    std::vector<double> light;
    double brightest = 0;
    for (int k = 0; k < count; ++k) {
        light.push_back(scan(tangent_x, std::tan(glm::radians(angle_deg(k)))));
        brightest = std::max(brightest, light.back());
    }
    if (!(brightest > 0.0))
        return std::nullopt;
    // Above the beam there may be no light at all, whose logarithm says nothing.
    constexpr double kDarkest = 1e-4;
    std::vector<double> slope;
    for (int k = 0; k + kSlopeSteps < count; ++k) {
        const auto at = static_cast<std::size_t>(k);
        slope.push_back(std::log((light[at] + kDarkest * brightest) /
                                 (light[at + kSlopeSteps] + kDarkest * brightest)));
    }
    const auto best =
        static_cast<std::size_t>(std::max_element(slope.begin(), slope.end()) - slope.begin());
    double shift = 0;
    if (best > 0 && best + 1 < slope.size()) {
        const double before = slope[best - 1], after = slope[best + 1];
        const double bend = before - 2 * slope[best] + after;
        shift = bend < 0 ? 0.5 * (before - after) / bend : 0;
    }
    return std::tan(glm::radians(angle_deg(static_cast<double>(best) + shift + 0.5 * kSlopeSteps)));
}

std::vector<double> cutoff_places() {
    // +x is the driver's left, where the line is level; it rises on the right up to 0.18.
    return {0.25, 0.2, 0.15, 0.1, 0.06, -0.04, -0.06, -0.08, -0.1, -0.12, -0.14};
}

}  // namespace nearfield::app
