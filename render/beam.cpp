// SPDX-License-Identifier: Apache-2.0
#include "render/beam.h"

#include <algorithm>

namespace nearfield::render {
namespace {

/// Bounds of one axis on one side of S: x >= low + low_slope z and x <= high + high_slope z.
struct Bounds {
    double low, low_slope, high, high_slope;
};

/// Beyond S lines cross over: the lowest one comes from U's highest point.
Bounds beyond_s(const Beam& beam, int axis) {
    return {beam.s_min_m[axis], (beam.s_min_m[axis] - beam.u_max_m[axis]) / beam.delta_m,
            beam.s_max_m[axis], (beam.s_max_m[axis] - beam.u_min_m[axis]) / beam.delta_m};
}

Bounds between(const Beam& beam, int axis) {
    return {beam.s_min_m[axis], (beam.s_min_m[axis] - beam.u_min_m[axis]) / beam.delta_m,
            beam.s_max_m[axis], (beam.s_max_m[axis] - beam.u_max_m[axis]) / beam.delta_m};
}

/// Whether all points lie beyond one of the bounds.
bool is_beside(const Bounds& bounds, int axis, std::span<const glm::dvec3> points_m) {
    return std::all_of(
               points_m.begin(), points_m.end(),
               [&](glm::dvec3 p) { return p[axis] < bounds.low + bounds.low_slope * p.z; }) ||
           std::all_of(points_m.begin(), points_m.end(), [&](glm::dvec3 p) {
               return p[axis] > bounds.high + bounds.high_slope * p.z;
           });
}

}  // namespace

Beam beam_of(const Slab& slab) {
    // Centers of the outermost functions, and half of a function's support of n pitches.
    const glm::dvec2 half_m =
        0.5 * (glm::dvec2(slab.grid - 1) + static_cast<double>(slab.profile.cells.size())) *
        slab.pitch_m;
    return {slab.u_center_m - half_m, slab.u_center_m + half_m, slab.s_min_m, slab.s_max_m,
            slab.delta_m};
}

std::array<glm::dvec3, 4> u_corners_m(const Beam& beam) {
    const double z = -beam.delta_m;
    return {glm::dvec3(beam.u_min_m, z), glm::dvec3(beam.u_max_m.x, beam.u_min_m.y, z),
            glm::dvec3(beam.u_min_m.x, beam.u_max_m.y, z), glm::dvec3(beam.u_max_m, z)};
}

bool may_meet(const Beam& beam, std::span<const glm::dvec3> points_m) {
    const auto [lowest, highest] = std::minmax_element(
        points_m.begin(), points_m.end(), [](glm::dvec3 a, glm::dvec3 b) { return a.z < b.z; });
    const bool meets_beyond = highest->z >= 0.0 && !is_beside(beyond_s(beam, 0), 0, points_m) &&
                              !is_beside(beyond_s(beam, 1), 1, points_m);
    const bool meets_between = lowest->z < 0.0 && highest->z > -beam.delta_m &&
                               !is_beside(between(beam, 0), 0, points_m) &&
                               !is_beside(between(beam, 1), 1, points_m);
    return meets_beyond || meets_between;
}

}  // namespace nearfield::render
