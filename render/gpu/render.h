// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/scene/scene.h"
#include "render/options.h"
#include "render/report.h"

namespace nearfield::render {

/// Renders on the graphics card, without a window: an OpenGL 4.5 context of its own for the call.
///
/// Light    as on the CPU: the windowed sum, or samples with the CPU's random numbers; lobes by
///          samples of lamp and lobe. Visibility by shadow maps of the lamps' cells instead of
///          rays: without noise, and with an error of its own that sigma does not hold.
/// Passes   strata of a pixel one after another (the same place in all pixels), and of samples
/// until
///          options.error_rel or options.time_s is reached.
/// Throws   Error if there is no context, if the driver reports an error (with the pass), or where
///          render_cpu would.
Rendered render_gl(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks = {});

}  // namespace nearfield::render
