// SPDX-License-Identifier: Apache-2.0
/// The reference renderer.
#pragma once

#include "formats/scene/scene.h"
#include "render/options.h"
#include "render/report.h"

namespace nearfield::render {

/// Renders the light that arrives directly from the scene's luminaires.
///
/// Out     without time_s the same bits for any number of threads. With the windowed sum noise in
///         penumbrae and gloss alone; its sigma is a layer, and with q > 0 the bias' bound too.
/// Throws  Error if a camera or light field is missing or not one, or if the picture is larger than
///         the memory that is left.
/// Cost    a camera sample and lit lamp: one windowed sum (prepared.h) a pass, and a shadow ray a
///         sample.
Rendered render_cpu(const Scene& scene,
                    const RenderOptions& options,
                    const RenderHooks& hooks = {});

}  // namespace nearfield::render
