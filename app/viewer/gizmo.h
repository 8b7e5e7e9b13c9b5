// SPDX-License-Identifier: Apache-2.0
/// Handles that move and turn a lamp: geometry alone, no window.
#pragma once

#include "app/viewer/view.h"

#include <glm/glm.hpp>

#include <array>
#include <optional>

namespace nearfield::viewer {

enum class HandleKind { Move, Turn };

/// An arrow along an axis, or a ring about it.
struct Handle {
    HandleKind kind = HandleKind::Move;
    int axis = 0;

    bool operator==(const Handle&) const = default;
};

struct Gizmo {
    glm::dvec3 at_world_m{0.0};
    std::array<glm::dvec3, 3> axes{};  // of unit length
    double size_m = 1;                 // of arrows; rings are 0.8 of it
};

constexpr double kRingOfSize = 0.8;

/// For a pose, as large on the picture as a share of its height. Axes: the world's, or the lamp's.
Gizmo gizmo_of(const glm::dmat4& world_from_luminaire,
               const Camera& camera,
               bool has_lamps_axes,
               double share_of_height = 0.18);

/// The handle nearest to the ray, as seen from where it starts, within an angle. The rings' far
/// halves count too.
std::optional<Handle> handle_at(const Gizmo& gizmo, const Ray& ray, double within_rad = 0.012);

/// Along the axis: from the gizmo's place to the point that is nearest to the ray, metres. Nothing
/// where the ray runs along the axis.
std::optional<double> along_axis_m(const Gizmo& gizmo, int axis, const Ray& ray);
/// About the axis: the angle at which the ray meets the ring's plane. Nothing where it does not.
std::optional<double> about_axis_rad(const Gizmo& gizmo, int axis, const Ray& ray);

/// A drag: the pose that the mouse has made of the one it began with, from where it took the
/// handle. step: multiples of it alone (metres, or degrees), 0: any. The pose it began with where a
/// ray says nothing.
struct Drag {
    Handle handle;
    Gizmo gizmo;  // when it began
    glm::dmat4 world_from_luminaire{1.0};
    Ray taken;
};
glm::dmat4 dragged(const Drag& drag, const Ray& ray, double step = 0);

}  // namespace nearfield::viewer
