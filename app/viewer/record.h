// SPDX-License-Identifier: Apache-2.0
/// Pictures in files.
#pragma once

#include "app/viewer/viewer.h"

#include <glm/glm.hpp>

#include <string>

namespace nearfield::viewer {

/// The picture that is shown, .png, as it is: without panels. Throws Error where it cannot be
/// written.
void write_shown(const Viewer& viewer, const std::string& path);

/// The picture of the view by the renderer's thread, as `nearfield render --device gl` writes it:
/// .exr with all layers, or .png. Progress::error says what goes wrong.
void write_picture_by(Worker& worker,
                      const Viewer& viewer,
                      glm::ivec2 size_px,
                      const std::string& path);

/// The same from cameras all around the pivot: PREFIX_001.png ..., with a scene PREFIX.gltf that
/// has these cameras, and PREFIX.sh, whose commands make them again without a window. Throws Error
/// where the scene cannot be written.
void record_turntable(Worker& worker,
                      const Viewer& viewer,
                      glm::ivec2 size_px,
                      const std::string& prefix,
                      int frames);

/// The same with one camera and a lamp that turns about the vertical, evenly from -span/2 to
/// span/2 of where it is; its partner mirrored. PREFIX_001.png ..., a scene PREFIX_001.gltf ...
/// each, and PREFIX.sh. Throws Error where no such lamp is there or a scene cannot be written.
void record_sweep(Worker& worker,
                  const Viewer& viewer,
                  glm::ivec2 size_px,
                  const std::string& prefix,
                  int frames,
                  int lamp,
                  double span_deg);

}  // namespace nearfield::viewer
