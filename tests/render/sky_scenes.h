// SPDX-License-Identifier: Apache-2.0
/// A floor without lamps under small environments.
#pragma once

#include "formats/environment/latlong.h"
#include "formats/scene/scene.h"
#include "render/cpu/render.h"

#include <cstddef>
#include <functional>
#include <string>

namespace nearfield::test {

/// Writes a picture into the working directory and returns what names it.
SceneEnvironment write_sky(const environment::LatLong& picture, const std::string& name);
SceneEnvironment constant_sky(glm::vec3 radiance);
SceneEnvironment sunny_sky();
/// A wide glow over the floor and little else, so that few directions show it well.
SceneEnvironment soft_sky();

/// A lobe of weight 1 without diffuse part.
shared::Brdf metal(shared::uint kind, float exponent, glm::vec2 alpha);

/// The floor alone, seen at a slant so that lobes of viewing angles up to 80 degrees are there, lit
/// by the sky.
Scene under(const SceneEnvironment& sky);
Scene under(const SceneEnvironment& sky, const shared::Brdf& brdf);

/// A small picture by the reference.
render::Rendered reference(const Scene& scene, int samples, bool has_shadows = true);

/// Calls with the index of each pixel that shows a surface; there are to be more than 100.
void for_each_surface(const Picture& picture, const std::function<void(std::size_t)>& check);

/// A ball of radius 0.6 above the floor, of the same material, with normals.
Scene with_ball(Scene scene);

/// Root mean square of a/b - 1 in green over pixels that show a surface.
double relative_rms(const Picture& a, const Picture& b);

/// Root mean square of a - b over the mean of b, likewise: suns leave pixels in which next to no
/// light is, and what any method adds there is large only relative to it.
double rms_of_mean(const Picture& a, const Picture& b);

}  // namespace nearfield::test
