// SPDX-License-Identifier: Apache-2.0
/// What is told of a fitted light field that never is in memory as a whole: sums over its images.
#pragma once

#include "formats/files/lightfield.h"

#include <functional>
#include <vector>

namespace nearfield::app {

/// The lens as it is seen from a direction.
struct LensView {
    glm::dvec2 tangent{0};  // of the direction, slab frame
    glm::dvec2 lower_m{0}, upper_m{0};
    glm::ivec2 size_px{0};
    std::vector<double> cd_per_m2;  // [row][column]
};

struct FitLight {
    double flux_lm = 0;
    double flux_sigma_lm = 0;  // of noise, and of the rig where there are replicates
    std::vector<double> on_s_lx, on_s_sigma_lx;  // [j][i]: of S without filter
    std::vector<LensView> views;                 // the brightest direction first
};

/// In      image: a slab of basis function m alone, with sigma and replicates
/// Cost    every image is asked for twice
FitLight light_of(const Slab& planes, const std::function<Slab(int m)>& image);

/// The same of a slab that is in memory.
FitLight light_of(const Slab& slab);

}  // namespace nearfield::app
