// SPDX-License-Identifier: Apache-2.0
/// A Lambertian disk as rays, and how the tests turn it into a light field.
#pragma once

#include "formats/model/luminaire.h"
#include "formats/rays/to_lightfield.h"
#include "tests/rays/ray_file.h"

namespace nearfield::test {

constexpr double kRadius_m = 2e-3, kFlux_lm = 100.0, kDisk_z_m = 3e-3;

/// Rays that start on the disk, or up to run_m beyond it.
inline rays::RaySet disk(std::size_t count, std::uint64_t seed, double run_m = 0.0) {
    rays::RaySet set;
    set.rays = lambertian_disk(count, kRadius_m, kDisk_z_m, kFlux_lm, seed, run_m);
    return set;
}

/// Fixed resolution: only the smoothing is chosen, which keeps tests quick.
inline rays::ConvertOptions quick() {
    rays::ConvertOptions options;
    options.slabs = 5;
    options.grid = glm::ivec2(9);
    options.texels = glm::ivec2(24);
    return options;
}

/// On a surface that faces -z.
inline double illuminance(const LightField& lf, glm::dvec3 position_m) {
    return model::luminance(model::irradiance(lf, {position_m, {0, 0, -1}}));
}

}  // namespace nearfield::test
