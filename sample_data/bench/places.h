// SPDX-License-Identifier: Apache-2.0
/// Where everything on the bench really is, drawn errors included; the camera's projection.
#pragma once

#include "formats/files/rigid.h"
#include "sample_data/bench/bench.h"

#include <glm/glm.hpp>

#include <optional>
#include <vector>

namespace nearfield::sample_data {

/// Poses and positions as realized.
struct Places {
    Rigid bench_from_filter, bench_from_screen, bench_from_lamp;
    std::vector<glm::dvec2> position_m;   // [row * columns + column], in `filter`
    std::vector<Rigid> bench_from_board;  // [view]
};

Places make_places(const Bench& bench);

/// Turn about x, then y, then z (a_from_b for a vector in b).
glm::dmat3 turn_xyz(glm::dvec3 angle_rad);

/// Picture position of a point in camera coordinates; none at or behind the center.
std::optional<glm::dvec2> project_px(const BenchCamera& camera, glm::dvec3 point_camera);

/// Direction (x, y, 1) in camera coordinates that is seen at a picture position: inverse of
/// project_px to 1e-12, by Newton's iteration.
glm::dvec3 ray_camera(const BenchCamera& camera, glm::dvec2 position_px);

/// Natural and polynomial vignetting at a picture position, whose ray has this tangent.
double vignetting(const BenchCamera& camera, glm::dvec2 position_px, glm::dvec2 tangent);

/// Where the line from origin along direction meets z = 0, as a multiple of direction; none if it
/// is parallel.
std::optional<double> meet_plane(glm::dvec3 origin, glm::dvec3 direction);

}  // namespace nearfield::sample_data
