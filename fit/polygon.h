// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace nearfield::fit {

/// Corners of a convex polygon, in order.
using Polygon = std::vector<glm::dvec2>;

/// Shoelace formula, about the first corner: large coordinates cancel before they are multiplied.
inline double signed_area(const Polygon& polygon) {
    double twice = 0.0;
    for (std::size_t c = 1; c + 1 < polygon.size(); ++c) {
        const glm::dvec2 a = polygon[c] - polygon[0], b = polygon[c + 1] - polygon[0];
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * twice;
}

inline std::pair<glm::dvec2, glm::dvec2> bounds(const Polygon& polygon) {
    glm::dvec2 least = polygon[0], most = polygon[0];
    for (const glm::dvec2 corner : polygon) {
        least = glm::min(least, corner);
        most = glm::max(most, corner);
    }
    return {least, most};
}

/// The part of a polygon where side * (x[axis] - border) >= 0.
/// Source    Sutherland and Hodgman, "Reentrant polygon clipping", 1974.
inline Polygon clipped(const Polygon& polygon, int axis, double border, double side) {
    Polygon kept;
    kept.reserve(polygon.size() + 1);
    for (std::size_t c = 0; c < polygon.size(); ++c) {
        const glm::dvec2 from = polygon[c], to = polygon[(c + 1) % polygon.size()];
        const double from_off = side * (from[axis] - border), to_off = side * (to[axis] - border);
        if (from_off >= 0.0)
            kept.push_back(from);
        if ((from_off > 0.0 && to_off < 0.0) || (from_off < 0.0 && to_off > 0.0))
            kept.push_back(from + (to - from) * (from_off / (from_off - to_off)));
    }
    return kept;
}

}  // namespace nearfield::fit
