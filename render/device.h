// SPDX-License-Identifier: Apache-2.0
/// The one place where a picture's device is chosen.
#pragma once

#include "formats/scene/scene.h"
#include "render/options.h"
#include "render/report.h"

namespace nearfield::render {

/// Renders on options.device. Auto: on the graphics card if there is an OpenGL context, else on the
/// CPU; the report says which, and why. Throws Error as the device's renderer does.
Rendered render(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks = {});

}  // namespace nearfield::render
