// SPDX-License-Identifier: Apache-2.0
#include "app/bench/wall_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::bench {
namespace {

constexpr int kTimedPasses = 3;

double best_us(const Target& target, const Method& method, std::vector<float>& y) {
    double best_s = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kTimedPasses; ++k)
        best_s = std::min(best_s, run_pass(target, method, 0, 0, y).time_s);
    return 1e6 * best_s / static_cast<double>(target.count());
}

WallPicture draw(const Target& target, const Method& method, std::uint32_t seed) {
    WallPicture picture;
    picture.sampler = method.name();
    picture.size = method.size();
    picture.time_us = best_us(target, method, picture.y);
    run_pass(target, method, 0, seed, picture.y);
    picture.error = render::relative_error(picture.y, target.truth_y);
    return picture;
}

}  // namespace

int size_for_time(const Target& target, Method method, double time_us) {
    constexpr int kFew = 16, kMany = 272, kMost = 1 << 20;
    std::vector<float> y;
    method.sampling->samples = kFew;
    const double few_us = best_us(target, method, y);
    method.sampling->samples = kMany;
    const double sample_us = std::max(1e-4, (best_us(target, method, y) - few_us) / (kMany - kFew));
    const double samples = kFew + (time_us - few_us) / sample_us;
    return static_cast<int>(std::clamp(std::round(samples), 1.0, static_cast<double>(kMost)));
}

WallPictures draw_wall(const Target& target,
                       const Wall& wall,
                       const std::vector<Method>& methods,
                       std::uint32_t seed) {
    WallPictures wall_pictures;
    wall_pictures.wall = wall;
    wall_pictures.truth_y = target.truth_y;
    wall_pictures.pictures.push_back(draw(target, Method{}, seed));
    const double time_us = wall_pictures.pictures.front().time_us;
    for (Method method : methods) {
        if (method.sampling)
            method.sampling->samples = size_for_time(target, method, time_us);
        wall_pictures.pictures.push_back(draw(target, method, seed));
    }
    return wall_pictures;
}

}  // namespace nearfield::bench
