// SPDX-License-Identifier: Apache-2.0
/// A lamp's pose as numbers that people type, and back.
#pragma once

#include <glm/glm.hpp>

namespace nearfield::viewer {

/// world_from_luminaire = translation, yaw about +y, pitch about x (up is positive), roll about the
/// light's axis, scale; mirrored: x turned over first.
struct PoseNumbers {
    glm::dvec3 position_world_m{0.0};
    double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
    double scale = 1;
    bool is_mirrored = false;
};

PoseNumbers numbers_of(const glm::dmat4& world_from_luminaire);
glm::dmat4 pose_of(const PoseNumbers& numbers);

/// Turned about its own place so that +z goes through the point; roll, scale and mirroring stay.
/// The same pose where the point is the lamp's own place.
glm::dmat4 aimed_at(const glm::dmat4& world_from_luminaire, glm::dvec3 at_world_m);

}  // namespace nearfield::viewer
