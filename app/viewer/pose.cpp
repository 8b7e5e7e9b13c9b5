// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/pose.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace nearfield::viewer {
namespace {

const glm::dvec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

}  // namespace

PoseNumbers numbers_of(const glm::dmat4& world_from_luminaire) {
    PoseNumbers numbers;
    numbers.position_world_m = glm::dvec3(world_from_luminaire[3]);
    glm::dmat3 turn(world_from_luminaire);
    numbers.is_mirrored = glm::determinant(turn) < 0.0;
    if (numbers.is_mirrored)
        turn[0] = -turn[0];
    numbers.scale = std::cbrt(glm::determinant(turn));
    turn /= numbers.scale;
    const glm::dvec3 ahead = turn[2];
    numbers.pitch_deg = glm::degrees(std::asin(std::clamp(ahead.y, -1.0, 1.0)));
    // Straight up or down yaw and roll are one: all of it is roll.
    const bool is_upright = std::hypot(ahead.x, ahead.z) < 1e-9;
    numbers.yaw_deg = is_upright ? 0.0 : glm::degrees(std::atan2(ahead.x, ahead.z));
    PoseNumbers without_roll = numbers;
    without_roll.scale = 1.0;
    without_roll.is_mirrored = false;
    const glm::dmat3 rolled = glm::transpose(glm::dmat3(pose_of(without_roll))) * turn;
    numbers.roll_deg = glm::degrees(std::atan2(rolled[0].y, rolled[0].x));
    return numbers;
}

glm::dmat4 pose_of(const PoseNumbers& numbers) {
    glm::dmat4 pose = glm::translate(glm::dmat4(1.0), numbers.position_world_m);
    pose = glm::rotate(pose, glm::radians(numbers.yaw_deg), kY);
    pose = glm::rotate(pose, -glm::radians(numbers.pitch_deg), kX);
    pose = glm::rotate(pose, glm::radians(numbers.roll_deg), kZ);
    return glm::scale(pose, numbers.scale * glm::dvec3(numbers.is_mirrored ? -1.0 : 1.0, 1.0, 1.0));
}

glm::dmat4 aimed_at(const glm::dmat4& world_from_luminaire, glm::dvec3 at_world_m) {
    PoseNumbers numbers = numbers_of(world_from_luminaire);
    const glm::dvec3 ahead = at_world_m - numbers.position_world_m;
    const double flat = std::hypot(ahead.x, ahead.z);
    if (!(std::hypot(flat, ahead.y) > 1e-9))
        return world_from_luminaire;
    numbers.pitch_deg = glm::degrees(std::atan2(ahead.y, flat));
    if (flat > 1e-9)
        numbers.yaw_deg = glm::degrees(std::atan2(ahead.x, ahead.z));
    return pose_of(numbers);
}

}  // namespace nearfield::viewer
