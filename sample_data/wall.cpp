// SPDX-License-Identifier: Apache-2.0
#include "sample_data/wall.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::sample_data {
namespace {

// Points darker than this part of the brightest do not count in relative errors.
constexpr double kDarkest = 1e-3;

void evaluate(const Headlight& headlight,
              const LightField& lightfield,
              double distance_m,
              std::vector<WallPoint>& points) {
    const double delta_m = lightfield.slabs.front().delta_m;
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t k) {
        // The formula measures z from the lens, the light field from S, delta ahead of it.
        model::Receiver receiver;
        receiver.position_m = {points[k].at_m, distance_m};
        points[k].truth_lx = model::luminance(irradiance(headlight, receiver));
        receiver.position_m.z -= delta_m;
        points[k].lightfield_lx = model::luminance(model::irradiance(lightfield, receiver));
    });
}

}  // namespace

std::vector<WallPoint> wall_points(const Headlight& headlight,
                                   const LightField& lightfield,
                                   double distance_m,
                                   glm::ivec2 points) {
    const glm::dvec2 lower_m = distance_m * kBeamMin - kLensHalf_m;
    const glm::dvec2 upper_m = distance_m * kBeamMax + kLensHalf_m;
    std::vector<WallPoint> grid;
    for (int row = 0; row < points.y; ++row) {
        for (int column = 0; column < points.x; ++column) {
            const glm::dvec2 share = (glm::dvec2(column, row) + 0.5) / glm::dvec2(points);
            grid.push_back({lower_m + share * (upper_m - lower_m)});
        }
    }
    evaluate(headlight, lightfield, distance_m, grid);
    return grid;
}

std::vector<WallPoint> wall_profile(const Headlight& headlight,
                                    const LightField& lightfield,
                                    double distance_m,
                                    double tangent_x,
                                    int points) {
    std::vector<WallPoint> line;
    for (int k = 0; k < points; ++k) {
        const double share = (k + 0.5) / points;
        const double tangent_y = kBeamMin.y + share * (kBeamMax.y - kBeamMin.y);
        line.push_back({distance_m * glm::dvec2(tangent_x, tangent_y)});
    }
    evaluate(headlight, lightfield, distance_m, line);
    return line;
}

WallError wall_error(const std::vector<WallPoint>& points, double distance_m) {
    WallError error;
    error.distance_m = distance_m;
    for (const WallPoint& point : points) {
        error.peak_lx = std::max(error.peak_lx, point.truth_lx);
    }
    std::vector<double> relative;
    for (const WallPoint& point : points) {
        const double difference_lx = point.lightfield_lx - point.truth_lx;
        error.max_of_peak = std::max(error.max_of_peak, std::abs(difference_lx) / error.peak_lx);
        if (point.truth_lx > kDarkest * error.peak_lx) {
            const double part = difference_lx / point.truth_lx;
            relative.push_back(std::abs(part));
            error.rms_rel += part * part;
            error.bias_rel += part;
        }
    }
    if (relative.empty()) {
        return error;
    }
    const double count = static_cast<double>(relative.size());
    error.rms_rel = std::sqrt(error.rms_rel / count);
    error.bias_rel /= count;
    std::sort(relative.begin(), relative.end());
    error.median_rel = relative[relative.size() / 2];
    error.p95_rel = relative[relative.size() * 95 / 100];
    error.max_rel = relative.back();
    return error;
}

}  // namespace nearfield::sample_data
