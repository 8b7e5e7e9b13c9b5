// SPDX-License-Identifier: Apache-2.0
/// How slabs that look along +z, +x, -x, +y, -y and -z share directions out.
#pragma once

#include <glm/glm.hpp>

#include <array>

namespace nearfield::model {

/// The slab of a direction's dominant axis: 0 ... 5 for +z, +x, -x, +y, -y, -z.
int dominant_slab(glm::vec3 direction);

/// The part of the light in a direction that each slab takes. Near the planes where two axes are
/// equally dominant it passes from one slab to the other smoothly (half-width: kHalfBand), so that
/// no slab's light ends in an edge that its basis functions could not follow. Sums to one, or is
/// all zero where the dominant axis has no slab. With one slab: all to it where z > 0.
std::array<float, 6> slab_shares(glm::vec3 direction, int slab_count);

/// The rotation of slab 0 ... 5: columns are its x, y and z in the frame of all.
glm::dmat3 axes_from_slab(int slab);

}  // namespace nearfield::model
