// SPDX-License-Identifier: Apache-2.0
/// A first guess of the lens and of the boards' poses.
#pragma once

#include "calibrate/bundle.h"
#include "calibrate/observations.h"

#include <optional>
#include <vector>

namespace nearfield::calibrate {

/// Pose of a flat board from where its corners are seen through a lens, by a homography (Hartley
/// and Zisserman, "Multiple view geometry", 2003, 4.1; Zhang 2000). None where corners do not
/// determine it: fewer than 4, all on a line, beyond the lens' picture.
std::optional<Rigid> flat_pose(const rig::Lens& lens, const std::vector<Corner>& corners);

/// A lens without distortion, its center the picture's, and all boards free. The focal length is
/// the one of a ladder, 0.2 to 20 picture widths in steps of a tenth, that shows boards best.
Bundle first_guess(const Observations& observations, rig::LensModel model);

/// Angle-axis of a rotation, rad.
glm::dvec3 angle_axis(const glm::dmat3& rotation);

}  // namespace nearfield::calibrate
