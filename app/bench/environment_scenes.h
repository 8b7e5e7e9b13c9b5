// SPDX-License-Identifier: Apache-2.0
/// What `bench environment` looks at: surfaces without lamps, by formula.
#pragma once

#include "formats/scene/scene.h"

#include <string>

namespace nearfield::bench {

/// A hall by formula: a dim room and eight lamps of 1.2 to 4 degrees, up to 4,000 times its mean.
/// Writes it as .exr, 256 x 128.
void write_hall(const std::string& path);

/// Darkness with one gray pixel of 1e6, 2 height x height.
void write_sun(const std::string& path, int height_px, glm::ivec2 pixel);

/// A plate of 2 x 2 about the origin that faces upwards and towards +z.
Mesh make_plate();

/// A ball of radius 1 with `rows` rows of quads twice as long; knobs: how far it is uneven.
Mesh make_ball(int rows, double knobs);

/// The first mesh of a file, in a ball of radius 1 about the origin.
Mesh read_mesh(const std::string& path);

/// The mesh alone, seen from +z, with this BRDF.
Scene scene_of(const Mesh& mesh, const shared::Brdf& brdf, const std::string& picture);

/// Adds a floor 1 below the origin, white and matt, and looks at both from above.
void add_floor(Scene& scene);

shared::Brdf phong(float exponent);
shared::Brdf ggx(float alpha);
shared::Brdf ward(float alpha_x, float alpha_y);
shared::Brdf matt();

}  // namespace nearfield::bench
