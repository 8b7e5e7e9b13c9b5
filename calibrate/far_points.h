// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/bundle.h"
#include "calibrate/geometry.h"

#include <Eigen/Core>
#include <glm/glm.hpp>

#include <optional>
#include <vector>

namespace nearfield::calibrate {

/// Points over the picture: the middles of count.x * count.y equal parts.
PictureMap map_points(glm::ivec2 size_px, glm::ivec2 count);

/// A point at infinity that the lens sees at a map's point, and how its picture moves.
struct FarPoint {
    std::size_t index = 0;  // in the map
    Eigen::Vector3d ray;
    Eigen::Matrix<double, 2, Eigen::Dynamic> by_lens;  // by the lens' numbers
    Eigen::Matrix<double, 2, 3> by_turn;               // by a small turn of the camera's frame
};

/// Those that the lens sees, with by_lens as it is once the turn is removed that brings all of them
/// nearest to where they were.
std::vector<FarPoint> far_points(const Bundle& bundle, const PictureMap& map);

/// Where a lens sees them once turned to fit the map's points best, minus the map's points.
std::vector<glm::dvec2> turned_differences_px(const Bundle& bundle,
                                              const PictureMap& map,
                                              const std::vector<FarPoint>& points);

}  // namespace nearfield::calibrate
