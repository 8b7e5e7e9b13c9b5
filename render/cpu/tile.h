// SPDX-License-Identifier: Apache-2.0
/// A picture's tiles: independent of each other, each the work of one thread at a time.
#pragma once

#include "render/cpu/lamps.h"
#include "render/cpu/render.h"
#include "render/cpu/tracer.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace nearfield::render {

constexpr int kTilePx = 16;  // 256 pixels: enough work a task, few enough idle cores at the end

/// What all tiles share.
struct Frame {
    const Scene& scene;
    const RenderOptions& options;
    const Camera& camera;
    const Lamps& lamps;
    const Tracer& tracer;
    Picture& picture;
    std::vector<Reflectance> reflectances;
    int strata = 1;  // a pixel's side
};

struct TileReport {
    double camera_s = 0, sums_s = 0, visibility_s = 0;
    std::uint64_t camera_rays = 0, shadow_rays = 0, multiply_adds = 0;
};

/// Layers in their order; behind the lamps' layers sigma_measured, where there is one.
enum LayerIndex : std::size_t {
    kRadiance,
    kIrradiance,
    kAlbedo,
    kDepth,
    kNormal,
    kSigma,
    kFirstLamp
};

/// Renders the pixels from `first` to `first + kTilePx` into the frame's picture.
void render_tile(const Frame& frame, glm::ivec2 first, TileReport& report);

}  // namespace nearfield::render
