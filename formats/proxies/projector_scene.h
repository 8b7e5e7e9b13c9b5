// SPDX-License-Identifier: Apache-2.0
/// Projector arrays as scene files of other renderers, with their pictures beside.
#pragma once

#include "formats/proxies/projectors.h"

#include <string>
#include <vector>

namespace nearfield::proxies {

enum class Renderer { Mitsuba3, Pbrt4 };

/// The scene's text. Picture k is named picture_names[k], as seen from the scene's folder. The
/// lamp's frame is the scene's; units are metres, and the quantity's own.
///     Mitsuba 3  a `projector` emitter each; E = pi scale texture / (z^2 cos), so scale is 1 / pi
///     pbrt-v4    a `projection` light each; its picture is intensity, irradiance / cos^3
std::string projector_scene(const std::vector<Projector>& projectors,
                            const std::vector<std::string>& picture_names,
                            Renderer renderer,
                            const std::string& lamp);

/// Writes a projector's picture as the renderer wants it: R, G, B, upright, the first column where
/// the renderer has it.
void write_projector_picture(const Projector& projector,
                             Renderer renderer,
                             const std::string& path);

}  // namespace nearfield::proxies
