// SPDX-License-Identifier: Apache-2.0
/// Geometry in a lamp's light, and what of it can throw shadows.
#pragma once

#include "formats/scene/scene.h"
#include "render/lamps.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::render {

/// Instances whose bounding box may lie in a lamp's beam, by index.
std::vector<std::size_t> instances_reached(const Scene& scene, const Lamp& lamp);

/// Why a lamp's light may throw shadows among the instances that it reaches, in words for people;
/// nothing where it cannot.
///
/// A segment from U to a surface crosses a triangle only if its ends lie on different sides of the
/// triangle's plane. So a plane with U and all geometry on one side stops no light. Sides are told
/// apart by more than shadow rays are: they start 16 units in the last place above a surface.
/// is_blocking[instance]: false where the lamp's light passes through.
std::optional<std::string> find_occluder(const Scene& scene,
                                         const Lamp& lamp,
                                         const std::vector<std::size_t>& reached,
                                         const std::vector<bool>& is_blocking);

/// "'post'", or "instance 3" where it has no name.
std::string name_of_instance(const Scene& scene, std::size_t instance);

}  // namespace nearfield::render
