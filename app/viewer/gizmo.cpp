// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/gizmo.h"

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace nearfield::viewer {
namespace {

constexpr double kParallel = 1e-4;  // sine of the angle below which a ray says nothing

double angle_to(const Ray& ray, glm::dvec3 world_m) {
    const glm::dvec3 to = world_m - ray.from_world_m;
    return std::atan2(glm::length(glm::cross(ray.direction, to)), glm::dot(ray.direction, to));
}

/// Seen from the ray's start: the angle between it and the arrow, which begins a little off the
/// gizmo's place, where all three meet.
double angle_to_arrow(const Gizmo& gizmo, int axis, const Ray& ray) {
    constexpr double kBegin = 0.15;
    const double along = along_axis_m(gizmo, axis, ray).value_or(gizmo.size_m);
    const double on_arrow = std::clamp(along, kBegin * gizmo.size_m, gizmo.size_m);
    return angle_to(ray, gizmo.at_world_m + on_arrow * gizmo.axes[static_cast<std::size_t>(axis)]);
}

glm::dvec3 on_ring(const Gizmo& gizmo, int axis, double angle_rad) {
    const auto& a = gizmo.axes;
    const auto u = static_cast<std::size_t>((axis + 1) % 3),
               v = static_cast<std::size_t>((axis + 2) % 3);
    return gizmo.at_world_m +
           kRingOfSize * gizmo.size_m * (std::cos(angle_rad) * a[u] + std::sin(angle_rad) * a[v]);
}

double angle_to_ring(const Gizmo& gizmo, int axis, const Ray& ray) {
    constexpr int kPoints = 96;
    double smallest = glm::pi<double>();
    for (int k = 0; k < kPoints; ++k)
        smallest = std::min(
            smallest, angle_to(ray, on_ring(gizmo, axis, glm::two_pi<double>() * k / kPoints)));
    return smallest;
}

double stepped(double value, double step) {
    return step > 0.0 ? step * std::round(value / step) : value;
}

}  // namespace

Gizmo gizmo_of(const glm::dmat4& world_from_luminaire,
               const Camera& camera,
               bool has_lamps_axes,
               double share_of_height) {
    Gizmo gizmo;
    gizmo.at_world_m = glm::dvec3(world_from_luminaire[3]);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 unit(0.0);
        unit[axis] = 1.0;
        gizmo.axes[static_cast<std::size_t>(axis)] =
            has_lamps_axes ? glm::normalize(glm::dvec3(world_from_luminaire[axis])) : unit;
    }
    if (glm::dot(glm::cross(gizmo.axes[0], gizmo.axes[1]), gizmo.axes[2]) < 0.0)
        gizmo.axes[0] = -gizmo.axes[0];  // of a mirrored lamp: angles turn right-handed
    const glm::dvec3 local =
        glm::dvec3(glm::inverse(camera.world_from_camera) * glm::dvec4(gizmo.at_world_m, 1.0));
    const double depth_m = std::max(std::abs(local.z), 1e-3);
    gizmo.size_m = share_of_height * 2.0 * depth_m * std::tan(0.5 * camera.yfov_rad);
    return gizmo;
}

std::optional<Handle> handle_at(const Gizmo& gizmo, const Ray& ray, double within_rad) {
    std::optional<Handle> nearest;
    for (const HandleKind kind : {HandleKind::Move, HandleKind::Turn})
        for (int axis = 0; axis < 3; ++axis) {
            const double angle = kind == HandleKind::Move ? angle_to_arrow(gizmo, axis, ray)
                                                          : angle_to_ring(gizmo, axis, ray);
            if (angle < within_rad) {
                within_rad = angle;
                nearest = Handle{kind, axis};
            }
        }
    return nearest;
}

std::optional<double> along_axis_m(const Gizmo& gizmo, int axis, const Ray& ray) {
    const glm::dvec3 along = gizmo.axes[static_cast<std::size_t>(axis)];
    const double cosine = glm::dot(along, ray.direction);
    const double square_of_sine = 1.0 - cosine * cosine;
    if (square_of_sine < kParallel * kParallel)
        return std::nullopt;
    // The lines' nearest points: what joins them is square to both.
    const glm::dvec3 from = ray.from_world_m - gizmo.at_world_m;
    return (glm::dot(from, along) - cosine * glm::dot(from, ray.direction)) / square_of_sine;
}

std::optional<double> about_axis_rad(const Gizmo& gizmo, int axis, const Ray& ray) {
    const auto& a = gizmo.axes;
    const auto n = static_cast<std::size_t>(axis), u = static_cast<std::size_t>((axis + 1) % 3),
               v = static_cast<std::size_t>((axis + 2) % 3);
    const double cosine = glm::dot(a[n], ray.direction);
    if (std::abs(cosine) < kParallel)
        return std::nullopt;
    const glm::dvec3 from = ray.from_world_m - gizmo.at_world_m;
    const glm::dvec3 met = from - ray.direction * (glm::dot(a[n], from) / cosine);
    return std::atan2(glm::dot(met, a[v]), glm::dot(met, a[u]));
}

glm::dmat4 dragged(const Drag& drag, const Ray& ray, double step) {
    const Handle handle = drag.handle;
    const glm::dvec3 axis = drag.gizmo.axes[static_cast<std::size_t>(handle.axis)];
    const bool moves = handle.kind == HandleKind::Move;
    const auto measure = moves ? along_axis_m : about_axis_rad;
    const std::optional<double> before = measure(drag.gizmo, handle.axis, drag.taken),
                                now = measure(drag.gizmo, handle.axis, ray);
    if (!before || !now)
        return drag.world_from_luminaire;
    glm::dmat4 pose = drag.world_from_luminaire;
    if (moves) {
        pose[3] += glm::dvec4(stepped(*now - *before, step) * axis, 0.0);
        return pose;
    }
    const double angle = stepped(*now - *before, glm::radians(step));
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, axis);
    const glm::dvec4 place = pose[3];
    pose = turn * pose;
    pose[3] = place;
    return pose;
}

}  // namespace nearfield::viewer
