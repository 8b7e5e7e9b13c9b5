// SPDX-License-Identifier: Apache-2.0
/// Where one looks from, and what is under the mouse.
#pragma once

#include "app/viewer/document.h"
#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>

namespace nearfield::viewer {

/// A camera, and the point before it that it is turned about.
struct View {
    Camera camera;
    double distance_m = 5;  // of that point, along the camera's axis
};

struct Ray {
    glm::dvec3 from_world_m{0.0}, direction{0.0, 0.0, -1.0};  // of unit length
};

glm::dvec3 eye_of(const View& view);
glm::dvec3 ahead_of(const View& view);
glm::dvec3 pivot_of(const View& view);

/// About the pivot: yaw about the world's up, pitch about the camera's right, short of straight up
/// and down.
View orbited(const View& view, double yaw_rad, double pitch_rad);
/// About the eye.
View looked_around(const View& view, double yaw_rad, double pitch_rad);
/// Eye and pivot move along the camera's right and up by pixels of a picture that high: what is at
/// the pivot's distance stays under the mouse.
View panned(const View& view, glm::dvec2 by_px, int height_px);
/// Nearer to the pivot by a factor below 1, farther by one above.
View dollied(const View& view, double factor);
/// Eye and pivot move: right, up, ahead.
View flown(const View& view, glm::dvec3 by_m);
/// Looks from a point to another.
View look_at(glm::dvec3 from_world_m, glm::dvec3 at_world_m, double yfov_rad);

/// From behind and above the lamps, as who drives what carries them, along their mean axis; from
/// high above what they light. The default view where there is no lamp.
View drivers_view(const Document& document);
View birds_view(const Document& document);

/// Through a position on the picture (x right, y down, in pixels).
Ray ray_through(const Camera& camera, glm::ivec2 size_px, glm::dvec2 position_px);
/// Where a point is on the picture; nothing where it is behind the eye.
std::optional<glm::dvec2> projected(const Camera& camera, glm::ivec2 size_px, glm::dvec3 world_m);

/// The lamp whose place is nearest to the position, within so many pixels.
std::optional<int> lamp_at(const Document& document,
                           const Camera& camera,
                           glm::ivec2 size_px,
                           glm::dvec2 position_px,
                           double within_px);

}  // namespace nearfield::viewer
