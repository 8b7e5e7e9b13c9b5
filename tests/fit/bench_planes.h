// SPDX-License-Identifier: Apache-2.0
/// Planes and positions of a bench on which the fit is tested.
#pragma once

#include "fit/design.h"
#include "formats/model/profile.h"
#include "tests/support/random.h"

#include <cmath>
#include <string>

namespace nearfield::fit {

/// Planes whose texels, pitches and centers differ along x and y.
inline Slab test_planes(glm::ivec2 grid = {11, 9}, const std::string& basis = "bspline") {
    Slab planes;
    planes.delta_m = 0.2;
    planes.grid = grid;
    planes.pitch_m = {0.0165, 0.015};
    planes.u_center_m = {0.004, -0.003};
    planes.texels = {8, 6};
    planes.s_min_m = {-0.13, -0.09};
    planes.s_max_m = {0.17, 0.11};
    planes.profile = model::make_profile(basis);
    return planes;
}

/// A filter at the grid's centers, each off by up to `error_m` along x, y and z.
inline Optics test_filter(const Slab& planes,
                          double error_m,
                          const std::string& profile = "bspline") {
    Optics optics;
    optics.filter_x = optics.filter_y = model::make_profile(profile);
    optics.filter_pitch_m = planes.pitch_m;
    support::Random random{7};
    for (int row = 0; row < planes.grid.y; ++row)
        for (int column = 0; column < planes.grid.x; ++column) {
            const auto off = [&] { return random.uniform(-error_m, error_m); };
            const glm::dvec3 error(off(), off(), off());
            optics.position_m.push_back(
                glm::dvec3(planes.basis_center_m(column, row), -planes.delta_m) + error);
        }
    return optics;
}

/// Standard normal (Box and Muller).
inline double normal_number(support::Random& random) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
    return radius * std::cos(2.0 * std::acos(-1.0) * random.uniform());
}

}  // namespace nearfield::fit
