// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <functional>
#include <vector>

namespace nearfield::farfield {

/// Three parameters that make a sum of squares least, by Levenberg and Marquardt's steps from
/// `start`; derivatives by differences over `step`. Directions of parameters that change nothing
/// (an axis of symmetry) keep their start. Cost: 7 evaluations a step, 20 steps at most.
glm::dvec3 least_squares(const std::function<std::vector<double>(const glm::dvec3&)>& residuals,
                         glm::dvec3 start,
                         double step);

}  // namespace nearfield::farfield
