// SPDX-License-Identifier: Apache-2.0
/// Small scenes whose light is known in closed form.
#pragma once

#include "formats/files/image.h"
#include "formats/files/lightfield.h"
#include "formats/scene/scene.h"

#include <glm/glm.hpp>

#include <string>

namespace nearfield::test {

const glm::dvec3 kDown(0, 0, -1);
constexpr double kWindowDelta = 0.1;  // of one_window_lamp

/// One square basis function of side `aperture_m` on U, one texel of `coefficient` on a wide S (0.6
/// m, 0.1 m before U). Irradiance weighting: E on any plane z = Delta is delta^2 coefficient
/// aperture^2 / (delta + Delta)^2.
LightField one_window_lamp(double aperture_m,
                           float coefficient,
                           Weighting weighting = Weighting::Irradiance);

/// Writes a light field into the working directory and returns a lamp that names it.
LuminaireInstance write_lamp(const LightField& lightfield,
                             const std::string& name,
                             const glm::dmat4& world_from_luminaire);

/// A rectangle in the plane z = 0 about the origin, facing +z.
Mesh rectangle(const std::string& name, glm::vec2 size_m);

/// A pose at `position`, the frame's +z (luminaire) along `direction`.
glm::dmat4 pose(glm::dvec3 position, glm::dvec3 direction);

/// A camera at `position` that looks along `direction`, +y of the picture near `up`.
Camera camera_at(glm::dvec3 position, glm::dvec3 direction, glm::dvec3 up, double yfov_rad);

/// A 4 m x 4 m floor at z = 0 of albedo 0.5, seen straight from above by a camera 4 m high.
Scene floor_scene();

/// Adds an instance of a rectangle in the plane z = height, centered at (x, y).
void add_blocker(Scene& scene, const std::string& name, glm::dvec3 center, glm::vec2 size_m);

const Layer& layer(const Picture& picture, const std::string& name);

/// Floor position (x, y) under the center of a pixel of floor_scene()'s camera.
glm::dvec2 floor_position(glm::ivec2 pixel, glm::ivec2 size_px);

/// A lamp with a square aperture of 0.2 m, half of it hidden from the floor's middle by a sheet
/// just below U's plane.
Scene half_covered();

/// An uneven lamp of 3 x 2 images in color, low over the floor and tilted, with a post in its
/// light.
Scene uneven_scene();

/// What calls for nothing: a gray Lambertian floor, a lamp of one channel.
Scene plain_scene();

/// The first lamp's file once more, named "second", elsewhere and dimmed.
Scene with_second_lamp(Scene scene);

/// The scene moved, lamps and cameras included.
Scene transformed(Scene scene, const glm::dmat4& matrix);

}  // namespace nearfield::test
