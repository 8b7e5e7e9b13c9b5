// SPDX-License-Identifier: Apache-2.0
/// Passes over the whole frame, each with samples of its own, until an error is reached or the time
/// is used up.
#pragma once

#include "render/cpu/tile.h"

namespace nearfield::render {

/// Renders the frame's picture, and fills the report's figures of passes, samples, times and noise.
/// hooks: clock_s is set; start_s: when the call of render() began on it.
void render_passes(Frame& frame, const RenderHooks& hooks, double start_s, RenderReport& report);

}  // namespace nearfield::render
