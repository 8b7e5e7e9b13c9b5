// SPDX-License-Identifier: Apache-2.0
#include "app/bench/target.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace nearfield::bench {
namespace {

// Share of the receivers that is left out at each end of the wall.
constexpr double kOutliers = 0.02;

double quantile(std::vector<double> values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double quantile(std::span<const model::Receiver> receivers, int axis, double share) {
    std::vector<double> values;
    for (const model::Receiver& receiver : receivers)
        values.push_back(receiver.position_m[axis]);
    return quantile(std::move(values), share);
}

model::ReceiverF rounded(const model::Receiver& receiver) {
    return {glm::vec3(receiver.position_m), glm::vec3(receiver.normal)};
}

model::Receiver widened(const model::ReceiverF& receiver) {
    return {glm::dvec3(receiver.position_m), glm::dvec3(receiver.normal)};
}

}  // namespace

Lamp make_lamp(const std::vector<Slab>& slabs) {
    Lamp lamp;
    for (const Slab& slab : slabs) {
        lamp.slabs.push_back(model::prepare_sampling(slab));
        lamp.mips.push_back(model::prepare_mips(slab));
    }
    return lamp;
}

Target make_target(const Lamp& lamp, std::span<const model::Receiver> receivers, glm::ivec2 size) {
    const std::size_t slabs = lamp.slabs.size();
    Target target;
    target.lamp = &lamp;
    target.size = size;
    target.receivers.resize(receivers.size() * slabs);
    target.truth_y.resize(receivers.size());
    for (std::size_t k = 0; k < receivers.size(); ++k)
        for (std::size_t s = 0; s < slabs; ++s)
            target.receivers[k * slabs + s] =
                rounded(model::to_slab(lamp.slabs[s].prepared.slab, receivers[k]));
    // Apart from the rounding above: inlined into one expression g++ 12 leaves it out.
    tbb::parallel_for(std::size_t{0}, receivers.size(), [&](std::size_t k) {
        double y = 0.0;
        for (std::size_t s = 0; s < slabs; ++s)
            y += model::luminance(model::irradiance(lamp.slabs[s].prepared.slab,
                                                    widened(target.receivers[k * slabs + s])));
        target.truth_y[k] = static_cast<float>(y);
    });
    return target;
}

Wall wall_of(std::span<const model::Receiver> receivers, glm::ivec2 size) {
    Wall wall;
    wall.size = size;
    wall.z_m = quantile(receivers, 2, 0.5);
    for (int axis = 0; axis < 2; ++axis) {
        wall.lower_m[axis] = quantile(receivers, axis, kOutliers);
        wall.upper_m[axis] = quantile(receivers, axis, 1.0 - kOutliers);
    }
    // A single point, or points in a row, still make a wall.
    const double least_m = std::max(1e-3, 0.25 * (wall.upper_m.x - wall.lower_m.x));
    const glm::dvec2 middle = 0.5 * (wall.lower_m + wall.upper_m);
    const glm::dvec2 half = 0.5 * glm::max(wall.upper_m - wall.lower_m, glm::dvec2(least_m));
    wall.lower_m = middle - half;
    wall.upper_m = middle + half;
    return wall;
}

std::vector<model::Receiver> receivers_on(const Wall& wall) {
    std::vector<model::Receiver> receivers;
    const glm::dvec2 step_m = (wall.upper_m - wall.lower_m) / glm::dvec2(wall.size);
    for (int row = 0; row < wall.size.y; ++row)
        for (int column = 0; column < wall.size.x; ++column) {
            const glm::dvec2 at_m = wall.lower_m + (glm::dvec2(column, row) + 0.5) * step_m;
            receivers.push_back({glm::dvec3(at_m, wall.z_m), {0.0, 0.0, -1.0}});
        }
    return receivers;
}

}  // namespace nearfield::bench
