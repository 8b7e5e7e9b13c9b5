// SPDX-License-Identifier: Apache-2.0
/// The demo's scene: a road at night, a wall across it, bollards, a parked car's box, and two
/// headlights.
///
/// World: metres, +y up, +z ahead of the car whose headlights these are, so +x to its LEFT
/// (right-handed). The road is y = 0, the headlights' lenses lie in z = 0, 0.65 m high and 1.2 m
/// apart, the wall is 11 m ahead of them.
#pragma once

#include "formats/scene/scene.h"

#include <string>

namespace nearfield::sample_data {

/// Both headlights show one luminaire file, whose planes are delta_m apart: its frame's origin lies
/// on S, that is delta_m ahead of the lens. `uri` is what the scene file says, `path` where the
/// file is. Cameras: "road" (the picture), "driver", "bird", "side".
Scene make_demo_scene(const std::string& uri, const std::string& path, double delta_m);

}  // namespace nearfield::sample_data
