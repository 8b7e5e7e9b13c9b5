// SPDX-License-Identifier: Apache-2.0
/// The part of space that a slab can light.
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <array>
#include <span>

namespace nearfield::render {

/// All lines from a rectangle on U (where basis functions are not 0) through S's rectangle, in the
/// slab's frame. No point outside receives light from the slab, behind U (z <= -delta) none at all.
struct Beam {
    glm::dvec2 u_min_m{0.0}, u_max_m{0.0};
    glm::dvec2 s_min_m{0.0}, s_max_m{0.0};
    double delta_m = 1.0;
};

Beam beam_of(const Slab& slab);

/// The corners of the rectangle on U, in the slab's frame.
std::array<glm::dvec3, 4> u_corners_m(const Beam& beam);

/// False where no point of the points' convex hull lies in the beam. Conservative: true also for
/// some that pass by it at a corner. points_m: in the slab's frame.
bool may_meet(const Beam& beam, std::span<const glm::dvec3> points_m);

}  // namespace nearfield::render
