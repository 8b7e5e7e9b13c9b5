// SPDX-License-Identifier: Apache-2.0
/// Where rays cross the planes of slabs.
#pragma once

#include "formats/rays/ray_set.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace nearfield::rays {

/// A ray where it crosses a slab's planes, in the slab's x and y.
struct Crossing {
    glm::vec2 u_m{0.0F}, s_m{0.0F};
    float flux = 0.0F;      // of the part of the ray that the slab takes
    float share = 1.0F;     // that part
    std::uint32_t ray = 0;  // index in the RaySet
};

/// A ray, or a part of it, that a slab takes.
struct Member {
    std::uint32_t ray = 0;  // index in the RaySet
    float share = 1.0F;
};

/// The planes of one slab along its axis, measured from the ray file's origin, and what of U and S
/// is used.
struct Planes {
    glm::dmat3 file_from_slab{1.0};  // proper rotation; its z axis is the slab's
    double u_m = 0, s_m = 0;         // u_m < s_m
    glm::dvec2 u_min_m{0}, u_max_m{0}, s_min_m{0}, s_max_m{0};
};

/// The plane along a slab's axis where its rays are narrowest: least flux-weighted mean square
/// distance from their mean position. Closed form. Rays that are all parallel have none: the mean
/// of their positions along the axis. `first_start_m`: the smallest start position along the axis.
struct Waist {
    double s_m = 0, first_start_m = 0;
};
Waist find_waist(const RaySet& set,
                 const std::vector<Member>& members,
                 const glm::dmat3& file_from_slab);

/// Propagates rays, backwards too, to planes.u_m and planes.s_m.
std::vector<Crossing> propagate(const RaySet& set,
                                const std::vector<Member>& members,
                                const Planes& planes);

/// The smallest rectangle that leaves out at most `trim` of the flux beyond each of its four edges,
/// and 2 % more.
struct Rectangle {
    glm::dvec2 min_m{0}, max_m{0};
};
Rectangle bound_s(const std::vector<Crossing>& crossings, double trim);
Rectangle bound_u(const std::vector<Crossing>& crossings, double trim);

}  // namespace nearfield::rays
