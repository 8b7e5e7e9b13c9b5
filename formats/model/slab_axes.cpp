// SPDX-License-Identifier: Apache-2.0
#include "formats/model/slab_axes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::model {
namespace {

// Half-width of the band where two slabs share light: the tangent, 5 degrees, of the angle to the
// plane between them. The band is then as wide as the pitch that 100,000 rays allow, which basis
// functions can follow; wider ones leave the slabs more directions to cover and coarser pitches.
constexpr float kHalfBand = 0.0875F;

// From 0 to 1 as the component `a` grows past `b` >= 0: precedence(a, b) + precedence(b, a) = 1.
float precedence(float a, float b) {
    // Of the angle to the plane a = b. Both may be zero: then the third axis takes all.
    const float tangent = (a - b) / std::max(a + b, std::numeric_limits<float>::min());
    return glm::smoothstep(-kHalfBand, kHalfBand, tangent);
}

}  // namespace

int dominant_slab(glm::vec3 direction) {
    const glm::vec3 size = glm::abs(direction);
    if (size.x > size.z && size.x >= size.y)
        return direction.x > 0 ? 1 : 2;
    if (size.y > size.z)
        return direction.y > 0 ? 3 : 4;
    return direction.z > 0 ? 0 : 5;
}

std::array<float, 6> slab_shares(glm::vec3 direction, int slab_count) {
    std::array<float, 6> shares{};
    if (slab_count == 1) {
        shares[0] = direction.z > 0 ? 1.0F : 0.0F;
        return shares;
    }
    if (dominant_slab(direction) >= slab_count)
        return shares;
    // Of each axis' two slabs the one that the direction points to.
    const glm::vec3 size = glm::abs(direction);
    const int slab[3] = {direction.x > 0 ? 1 : 2, direction.y > 0 ? 3 : 4, direction.z > 0 ? 0 : 5};
    const float weight[3] = {precedence(size.x, size.y) * precedence(size.x, size.z),
                             precedence(size.y, size.x) * precedence(size.y, size.z),
                             precedence(size.z, size.x) * precedence(size.z, size.y)};
    float sum = 0.0F;
    for (int axis = 0; axis < 3; ++axis)
        sum += slab[axis] < slab_count ? weight[axis] : 0.0F;
    for (int axis = 0; axis < 3; ++axis)
        if (slab[axis] < slab_count)
            shares[static_cast<std::size_t>(slab[axis])] = weight[axis] / sum;
    return shares;
}

glm::dmat3 axes_from_slab(int slab) {
    const glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    switch (slab) {
        case 1:
            return {y, z, x};
        case 2:
            return {-y, z, -x};
        case 3:
            return {z, x, y};
        case 4:
            return {-z, x, -y};
        case 5:
            return {-x, y, -z};
        default:
            return {x, y, z};
    }
}

}  // namespace nearfield::model
