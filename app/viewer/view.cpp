// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/view.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace nearfield::viewer {
namespace {

const glm::dvec3 kUp(0, 1, 0);
constexpr double kMostPitch_rad = 1.55;  // a degree short of straight up

glm::dmat3 turn_of(const View& view) {
    return glm::dmat3(view.camera.world_from_camera);
}

/// The turn after yaw and pitch, of which the latter stops before the poles.
glm::dmat3 turned(const View& view, double yaw_rad, double pitch_rad) {
    const glm::dmat3 turn = turn_of(view);
    const double pitch_before = std::asin(std::clamp(glm::normalize(-turn[2]).y, -1.0, 1.0));
    const double pitch =
        std::clamp(pitch_before + pitch_rad, -kMostPitch_rad, kMostPitch_rad) - pitch_before;
    const glm::dmat4 about_right = glm::rotate(glm::dmat4(1.0), pitch, glm::normalize(turn[0]));
    const glm::dmat4 about_up = glm::rotate(glm::dmat4(1.0), yaw_rad, kUp);
    return glm::dmat3(about_up) * glm::dmat3(about_right) * turn;
}

View placed(const View& view, const glm::dmat3& turn, glm::dvec3 eye_world_m) {
    View next = view;
    next.camera.world_from_camera = glm::dmat4(turn);
    next.camera.world_from_camera[3] = glm::dvec4(eye_world_m, 1.0);
    return next;
}

struct Beams {
    glm::dvec3 from_world_m{0.0}, ahead{0.0, 0.0, 1.0};
};

std::optional<Beams> beams_of(const Document& document) {
    if (document.lamps.empty())
        return std::nullopt;
    Beams beams{glm::dvec3(0.0), glm::dvec3(0.0)};
    for (const EditedLamp& lamp : document.lamps) {
        const glm::dmat4& pose = lamp.luminaire.world_from_luminaire;
        beams.from_world_m += glm::dvec3(pose[3]) / static_cast<double>(document.lamps.size());
        beams.ahead += glm::normalize(glm::dvec3(pose[2]));
    }
    beams.ahead.y = 0.0;
    beams.ahead =
        glm::length(beams.ahead) > 1e-6 ? glm::normalize(beams.ahead) : glm::dvec3(0.0, 0.0, 1.0);
    return beams;
}

}  // namespace

glm::dvec3 eye_of(const View& view) {
    return glm::dvec3(view.camera.world_from_camera[3]);
}

glm::dvec3 ahead_of(const View& view) {
    return -glm::normalize(glm::dvec3(view.camera.world_from_camera[2]));
}

glm::dvec3 pivot_of(const View& view) {
    return eye_of(view) + view.distance_m * ahead_of(view);
}

View orbited(const View& view, double yaw_rad, double pitch_rad) {
    const glm::dmat3 turn = turned(view, yaw_rad, pitch_rad);
    return placed(view, turn, pivot_of(view) + view.distance_m * glm::normalize(turn[2]));
}

View looked_around(const View& view, double yaw_rad, double pitch_rad) {
    return placed(view, turned(view, yaw_rad, pitch_rad), eye_of(view));
}

View panned(const View& view, glm::dvec2 by_px, int height_px) {
    const double m_per_px =
        2.0 * view.distance_m * std::tan(0.5 * view.camera.yfov_rad) / height_px;
    return flown(view, {-by_px.x * m_per_px, by_px.y * m_per_px, 0.0});
}

View dollied(const View& view, double factor) {
    View next = view;
    next.distance_m = std::clamp(view.distance_m * factor, 1e-3, 1e6);
    return placed(next, turn_of(view), pivot_of(view) - next.distance_m * ahead_of(view));
}

View flown(const View& view, glm::dvec3 by_m) {
    const glm::dmat3 turn = turn_of(view);
    return placed(view, turn,
                  eye_of(view) + by_m.x * glm::normalize(turn[0]) +
                      by_m.y * glm::normalize(turn[1]) + by_m.z * ahead_of(view));
}

View look_at(glm::dvec3 from_world_m, glm::dvec3 at_world_m, double yfov_rad) {
    View view;
    const glm::dvec3 ahead = glm::normalize(at_world_m - from_world_m);
    const glm::dvec3 up = std::abs(ahead.y) > 0.999 ? glm::dvec3(0.0, 0.0, 1.0) : kUp;
    view.camera.world_from_camera = glm::inverse(glm::lookAt(from_world_m, at_world_m, up));
    view.camera.yfov_rad = yfov_rad;
    view.distance_m = glm::length(at_world_m - from_world_m);
    return view;
}

View drivers_view(const Document& document) {
    const Beams beams = beams_of(document).value_or(Beams{});
    return look_at(beams.from_world_m - 1.6 * beams.ahead + 0.6 * kUp,
                   beams.from_world_m + 11.0 * beams.ahead, glm::radians(28.0));
}

View birds_view(const Document& document) {
    const Beams beams = beams_of(document).value_or(Beams{});
    const glm::dvec3 at = beams.from_world_m + 6.0 * beams.ahead;
    return look_at(at - 2.0 * beams.ahead + 12.0 * kUp, at, glm::radians(50.0));
}

Ray ray_through(const Camera& camera, glm::ivec2 size_px, glm::dvec2 position_px) {
    const double unit_px = 0.5 * size_px.y / std::tan(0.5 * camera.yfov_rad);
    const glm::dvec3 local((position_px.x - 0.5 * size_px.x) / unit_px,
                           (0.5 * size_px.y - position_px.y) / unit_px, -1.0);
    return {glm::dvec3(camera.world_from_camera[3]),
            glm::normalize(glm::dmat3(camera.world_from_camera) * local)};
}

std::optional<glm::dvec2> projected(const Camera& camera, glm::ivec2 size_px, glm::dvec3 world_m) {
    const glm::dvec3 local =
        glm::dvec3(glm::inverse(camera.world_from_camera) * glm::dvec4(world_m, 1.0));
    if (!(local.z < -1e-6))
        return std::nullopt;
    const double unit_px = 0.5 * size_px.y / std::tan(0.5 * camera.yfov_rad);
    return glm::dvec2(0.5 * size_px.x - unit_px * local.x / local.z,
                      0.5 * size_px.y + unit_px * local.y / local.z);
}

std::optional<int> lamp_at(const Document& document,
                           const Camera& camera,
                           glm::ivec2 size_px,
                           glm::dvec2 position_px,
                           double within_px) {
    std::optional<int> nearest;
    for (const EditedLamp& lamp : document.lamps) {
        const std::optional<glm::dvec2> at =
            projected(camera, size_px, glm::dvec3(lamp.luminaire.world_from_luminaire[3]));
        if (!at || glm::length(*at - position_px) > within_px)
            continue;
        within_px = glm::length(*at - position_px);
        nearest = lamp.id;
    }
    return nearest;
}

}  // namespace nearfield::viewer
