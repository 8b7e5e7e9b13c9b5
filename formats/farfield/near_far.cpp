// SPDX-License-Identifier: Apache-2.0
#include "formats/farfield/near_far.h"

#include "formats/farfield/lamp_view.h"
#include "formats/files/error.h"
#include "formats/model/luminaire.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace nearfield::farfield {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr int kRungs = 25;
constexpr double kFarthestSizes = 1024;
// Below this part of the peak a direction counts as dark.
constexpr double kDark = 0.01;

// A direction in which distances are tried.
struct Line {
    glm::dvec3 center_m, direction;
    double intensity = 0;

    model::Receiver at(double distance_m) const {
        return {center_m + distance_m * direction, -direction};
    }
};

double error_at(const LightField& lightfield,
                const NearFarOptions& options,
                const Line& line,
                double distance_m) {
    const double truth = model::luminance(model::irradiance(lightfield, line.at(distance_m)));
    const double by_stand_in = options.stand_in ? options.stand_in(line.at(distance_m))
                                                : line.intensity / (distance_m * distance_m);
    return truth > 0 ? std::abs(by_stand_in / truth - 1) : std::numeric_limits<double>::infinity();
}

// From far to near, until all errors are exceeded.
std::array<double, 3> distances_m(const LightField& lightfield,
                                  const NearFarOptions& options,
                                  const Line& line,
                                  double lamp_size) {
    std::array<double, 3> found;
    found.fill(std::numeric_limits<double>::infinity());
    std::array<bool, 3> is_exceeded{};
    double before_m = 0, before_error = 0;
    for (int rung = 0; rung < kRungs; ++rung) {
        const double distance_m = kFarthestSizes * lamp_size * std::exp2(-0.5 * rung);
        const double error = error_at(lightfield, options, line, distance_m);
        for (std::size_t k = 0; k < options.errors.size(); ++k) {
            if (is_exceeded[k])
                continue;
            if (error < options.errors[k]) {
                found[k] = distance_m;
                continue;
            }
            is_exceeded[k] = true;
            if (rung > 0 && std::isfinite(error) && before_error > 0) {
                const double t =
                    std::log(options.errors[k] / before_error) / std::log(error / before_error);
                found[k] = before_m * std::pow(distance_m / before_m, std::clamp(t, 0.0, 1.0));
            }
        }
        if (is_exceeded == std::array{true, true, true})
            break;
        before_m = distance_m;
        before_error = error;
    }
    return found;
}

double angle_of_most_light_deg(const std::vector<WeightedDirection>& lit) {
    std::vector<std::pair<double, double>> angles;
    for (const WeightedDirection& at : lit)
        if (at.direction.z > 0)
            angles.emplace_back(
                std::atan(std::max(std::abs(at.direction.x), std::abs(at.direction.y)) /
                          at.direction.z) /
                    kRadPerDeg,
                at.weight);
    constexpr double kMostLight = 0.99, kWidest_deg = 80, kNarrowest_deg = 0.1;
    if (angles.empty())
        throw Error{"map of distances", "luminaire", "light that goes towards +z", "none"};
    return std::clamp(weighted_quantile(angles, kMostLight), kNarrowest_deg, kWidest_deg);
}

// Half and 95 % of the light: directions weighted by the flux that they stand for.
void summarize_light(NearFarMap& map) {
    for (std::size_t k = 0; k < map.errors.size(); ++k) {
        std::vector<std::pair<double, double>> distances;
        for (std::size_t n = 0; n < map.intensity.size(); ++n) {
            if (std::isnan(map.distance_m[k][n]))
                continue;
            const int size = map.size;
            const auto angle = [&](std::size_t at) {
                return kRadPerDeg * map.half_angle_deg *
                       (2.0 * static_cast<double>(at) / (size - 1) - 1);
            };
            const double x = std::tan(angle(n % static_cast<std::size_t>(size)));
            const double y = std::tan(angle(n / static_cast<std::size_t>(size)));
            // d omega = cos^3 dx dy, dx = (1 + x^2) dh
            const double solid = (1 + x * x) * (1 + y * y) / std::pow(1 + x * x + y * y, 1.5);
            distances.emplace_back(map.distance_m[k][n], map.intensity[n] * solid);
        }
        map.median_m[k] = weighted_quantile(distances, 0.5);
        map.p95_m[k] = weighted_quantile(distances, 0.95);
    }
}

}  // namespace

NearFarMap near_far_map(const LightField& lightfield, const NearFarOptions& options) {
    if (options.size < 3 || options.size > 501 || options.size % 2 == 0)
        throw Error{"map of distances", "size", "odd, 3 ... 501", fmt::format("{}", options.size)};
    if (options.half_angle_deg && !(*options.half_angle_deg > 0 && *options.half_angle_deg <= 85))
        throw Error{"map of distances", "half angle", "above 0, at most 85 degrees",
                    fmt::format("{}", *options.half_angle_deg)};
    const LampView lamp = view_of(lightfield);
    constexpr int kRays = 4096;
    NearFarMap map;
    map.errors = options.errors;
    map.size = options.size;
    map.half_angle_deg =
        options.half_angle_deg.value_or(angle_of_most_light_deg(lit_directions(lamp, kRays, 0)));
    map.center_m = light_center_m(lightfield);
    map.lamp_size_m = lamp_size_m(lightfield);
    const auto size = static_cast<std::size_t>(map.size);
    map.intensity.resize(size * size);
    map.sigma.resize(size * size);
    for (std::vector<double>& distances : map.distance_m)
        distances.assign(size * size, std::numeric_limits<double>::quiet_NaN());
    const auto direction_at = [&](std::size_t n) {
        const auto tangent = [&](std::size_t at) {
            return std::tan(kRadPerDeg * map.half_angle_deg *
                            (2.0 * static_cast<double>(at) / (map.size - 1) - 1));
        };
        return glm::normalize(glm::dvec3(tangent(n % size), tangent(n / size), 1));
    };
    tbb::parallel_for(std::size_t{0}, size * size, [&](std::size_t n) {
        map.intensity[n] = lamp.intensity(direction_at(n));
        map.sigma[n] = lamp.intensity_sigma(direction_at(n));
    });
    const double peak = *std::max_element(map.intensity.begin(), map.intensity.end());
    tbb::parallel_for(std::size_t{0}, size * size, [&](std::size_t n) {
        if (!(map.intensity[n] > kDark * peak))
            return;
        const auto found =
            distances_m(lightfield, options, {map.center_m, direction_at(n), map.intensity[n]},
                        map.lamp_size_m);
        for (std::size_t k = 0; k < found.size(); ++k)
            map.distance_m[k][n] = found[k];
    });
    summarize_light(map);
    return map;
}

}  // namespace nearfield::farfield
