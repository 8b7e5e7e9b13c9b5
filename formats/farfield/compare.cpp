// SPDX-License-Identifier: Apache-2.0
#include "formats/farfield/compare.h"

#include "formats/farfield/align.h"
#include "formats/files/error.h"
#include "formats/model/luminaire.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>

namespace nearfield::farfield {
namespace {

struct Pair {
    double a = 0, b = 0, sigma = 0;
};

Differences summarize(const std::vector<WeightedDirection>& at, const std::vector<Pair>& pairs) {
    Differences result;
    std::vector<std::pair<double, double>> sizes;
    double whole = 0, squares = 0, in_sigmas = 0, sigmas = 0, with_sigma = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto [a, b, sigma] = pairs[k];
        const double mean = 0.5 * (a + b), weight = at[k].weight;
        if (!(mean > 0))
            continue;
        const double relative = (b - a) / mean;
        whole += weight;
        result.mean_rel += weight * relative;
        squares += weight * relative * relative;
        sizes.emplace_back(std::abs(relative), weight);
        if (sigma > 0) {
            with_sigma += weight;
            in_sigmas += weight * (b - a) * (b - a) / (sigma * sigma);
            sigmas += weight * sigma * sigma / (mean * mean);
        }
        if (std::abs(b - a) > result.worst) {
            result.worst = std::abs(b - a);
            result.worst_direction = at[k].direction;
        }
    }
    if (!(whole > 0))
        return result;
    result.mean_rel /= whole;
    result.rms_rel = std::sqrt(squares / whole);
    result.median_rel = weighted_quantile(sizes, 0.5);
    result.p95_rel = weighted_quantile(sizes, 0.95);
    if (with_sigma > 0) {
        result.rms_in_sigmas = std::sqrt(in_sigmas / with_sigma);
        result.sigma_rel = std::sqrt(sigmas / with_sigma);
    }
    return result;
}

// Directions in A's frame where either lamp shines, each lamp's of the same weight in all.
std::vector<WeightedDirection> directions_of_both(const LampView& a,
                                                  const LampView& b,
                                                  const Rigid& a_from_b,
                                                  const CompareOptions& options) {
    std::vector<WeightedDirection> all;
    const auto add = [&](const LampView& lamp, const glm::dmat3& to_a) {
        const auto own = lit_directions(lamp, options.directions, options.seed);
        double whole = 0;
        for (const WeightedDirection& at : own)
            whole += at.weight;
        for (const WeightedDirection& at : own)
            all.push_back({to_a * at.direction, at.weight / whole});
    };
    add(a, glm::dmat3(1.0));
    add(b, a_from_b.rotation);
    return all;
}

void check(const LampView& a, const LampView& b, const CompareOptions& options) {
    if (options.directions < 10 || options.directions > 1000000)
        throw Error{"comparison of lamps", "directions", "10 ... 1000000",
                    fmt::format("{}", options.directions)};
    const auto quantity = [](const LampView& lamp) {
        return lamp.lightfield == nullptr ? Quantity::Photometric : lamp.lightfield->quantity;
    };
    if (quantity(a) != quantity(b))
        throw Error{"comparison of lamps", "quantity", "both photometric or both radiometric",
                    "one of each"};
}

Differences near_differences(const LampView& a,
                             const LampView& b,
                             const Rigid& a_from_b,
                             const std::vector<WeightedDirection>& at,
                             double distance_m) {
    const glm::dvec3 center_m = light_center_m(*a.lightfield);
    const glm::dmat3 b_from_a = glm::transpose(a_from_b.rotation);
    std::vector<Pair> pairs(at.size());
    tbb::parallel_for(std::size_t{0}, at.size(), [&](std::size_t k) {
        const model::Receiver receiver{center_m + distance_m * at[k].direction, -at[k].direction};
        const model::Receiver there{b_from_a * (receiver.position_m - a_from_b.translation_m),
                                    b_from_a * receiver.normal};
        pairs[k] = {model::luminance(model::irradiance(*a.lightfield, receiver)),
                    model::luminance(model::irradiance(*b.lightfield, there)),
                    std::hypot(model::irradiance_sigma_y(*a.lightfield, receiver),
                               model::irradiance_sigma_y(*b.lightfield, there))};
    });
    return summarize(at, pairs);
}

}  // namespace

Comparison compare(const LampView& a,
                   const LampView& b,
                   const Rigid& a_from_b,
                   const CompareOptions& options) {
    check(a, b, options);
    Comparison result{a.flux, b.flux, a.flux_sigma, b.flux_sigma, {}, {}};
    const std::vector<WeightedDirection> at = directions_of_both(a, b, a_from_b, options);
    std::vector<Pair> pairs(at.size());
    tbb::parallel_for(std::size_t{0}, at.size(), [&](std::size_t k) {
        const glm::dvec3 there = direction_in_b(a_from_b, at[k].direction);
        pairs[k] = {a.intensity(at[k].direction), b.intensity(there),
                    std::hypot(a.intensity_sigma(at[k].direction), b.intensity_sigma(there))};
    });
    result.intensity = summarize(at, pairs);
    if (a.lightfield != nullptr && b.lightfield != nullptr)
        for (const double sizes : options.distances_sizes) {
            const double distance_m = sizes * lamp_size_m(*a.lightfield);
            result.near_field.push_back(
                {distance_m, near_differences(a, b, a_from_b, at, distance_m)});
        }
    return result;
}

}  // namespace nearfield::farfield
