// SPDX-License-Identifier: Apache-2.0
/// The parts of prepare().
#pragma once

#include "sample_data/bench/lens_light.h"
#include "sample_data/bench/prepared.h"
#include "sample_data/bench/ray_lamp.h"

#include <functional>
#include <vector>

namespace nearfield::sample_data {

inline int position_count(const Bench& bench) {
    return bench.filter.grid.x * bench.filter.grid.y;
}

/// How the pixels weigh the scene's channels after something that reflects by channel.
SeenColors seen_colors(const Bench& bench, glm::dvec3 reflectance);

/// What white light of luminance 1 gives, since R = G = B = Y then.
inline double channel_sum(glm::dvec3 weights) {
    return weights.x + weights.y + weights.z;
}

/// Pictures of the screen (positions, open, room) and their error.
void prepare_screen(const RayLamp& lamp,
                    const std::function<void(double)>& progress,
                    PreparedBench& prepared);

/// Light held back that strays evenly all the same, as one color weighs it. From a coarse grid on
/// what the camera sees of the screen.
struct StrayedLight {
    std::vector<double> positions;
    double blocked = 0;  // an opaque plate holds back everything
};
StrayedLight strayed_light(const LensLight& light, const SeenColors& color);

/// Pictures by a camera that looks into the lamp.
void prepare_direct(const RayLamp& lamp,
                    const std::function<void(double)>& progress,
                    PreparedBench& prepared);

/// Pictures of the board, and of the even source.
void prepare_targets(PreparedBench& prepared);

}  // namespace nearfield::sample_data
