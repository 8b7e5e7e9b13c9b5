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

/// The slab of a direction's dominant axis: 0 ... 5 for +z, +x, -x, +y, -y, -z.
int dominant_slab(glm::vec3 direction);

/// The part of a ray that each slab takes. Near the planes where two axes are equally dominant it
/// passes from one slab to the other smoothly (half-width: kHalfBand), so that no slab's light ends
/// in an edge that its basis functions could not follow. Sums to one, or is all zero where the
/// dominant axis has no slab. With one slab: all to it where z > 0.
std::array<float, 6> slab_shares(glm::vec3 direction, int slab_count);

/// The rotation of slab 0 ... 5.
glm::dmat3 file_from_slab(int slab);

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
