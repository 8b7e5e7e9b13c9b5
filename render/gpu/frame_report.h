// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/gpu/passes.h"
#include "render/report.h"

#include <cstdint>
#include <vector>

namespace nearfield::render::gpu {

/// Fills the picture's albedo, depth and normal with what was drawn last. brdfs: [material].
void read_surfaces(const Surfaces& surfaces,
                   const std::vector<shared::Brdf>& brdfs,
                   Picture& picture);

/// The same, depth alone: 0 where nothing is seen.
void read_depth(const Surfaces& surfaces, Picture& picture);

/// What passes took since the device's costs were cleared, and what they hold, by the plan's
/// passes.
void report_costs(const GlFrame& frame, std::uint64_t surface_bytes, RenderReport& report);

}  // namespace nearfield::render::gpu
