// SPDX-License-Identifier: Apache-2.0
/// Pictures of a wall lit by the lamp, by every sampler in about the same time.
#pragma once

#include "app/bench/measure.h"

#include <string>
#include <vector>

namespace nearfield::bench {

struct WallPicture {
    std::string sampler;
    int size = 0;        // K or Q; 0: exact
    double time_us = 0;  // wall time a pixel
    render::RelativeError error;
    std::vector<float> y;  // [pixel], as Target orders receivers
};

struct WallPictures {
    Wall wall;
    std::vector<float> truth_y;  // empty: no pictures
    std::vector<WallPicture> pictures;
};

/// The K with which a method takes time_us a receiver, at least 1: from its times at two K.
int size_for_time(const Target& target, Method method, double time_us);

/// The exact sum, and each method: with as many samples as that time buys, a sum as it is.
WallPictures draw_wall(const Target& target,
                       const Wall& wall,
                       const std::vector<Method>& methods,
                       std::uint32_t seed);

}  // namespace nearfield::bench
