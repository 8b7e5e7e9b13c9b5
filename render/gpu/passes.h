// SPDX-License-Identifier: Apache-2.0
/// A frame's passes on the graphics card, until what is asked for is reached.
#pragma once

#include "render/gpu/film.h"
#include "render/gpu/lamps.h"
#include "render/gpu/scene_buffers.h"
#include "render/gpu/sky_light.h"
#include "render/gpu/surfaces.h"
#include "render/opening.h"
#include "render/report.h"

#include <cstdint>
#include <optional>

namespace nearfield::render::gpu {

/// What a frame is drawn from, and into.
struct GlFrame {
    const Scene& scene;
    const RenderOptions& options;
    const Opening& opening;
    const Plan& plan;
    Device& device;
    const SceneBuffers& scene_buffers;
    SurfacePass& surfaces;
    LampsOnCard& on_card;
    LightPasses& passes;
    Film& film;
    const SkyKept* sky = nullptr;                         // null: darkness all around
    std::optional<std::size_t> only_lamp = std::nullopt;  // of opening.lamps; none: all of them

    bool draws(std::size_t lamp) const {
        return plan.lamps[lamp].is_lit && only_lamp.value_or(lamp) == lamp;
    }
};

/// Renders the shadow maps that the plan calls for and that are not there.
void draw_shadow_maps(GlFrame& frame, const ShadowPass& pass);

/// One sample of each pixel at `at_px` of it (0.5, 0.5: the middle), lit by every lamp and added to
/// the film. query: samples of a pixel and lamp, and the first lamp's first set; the other lamps'
/// follow, kMostSets each. camera_sample: counted through all of a pixel's.
void add_pass(GlFrame& frame,
              glm::dvec2 at_px,
              const SampleQuery& query,
              std::uint32_t camera_sample,
              float weight);

/// Passes over all strata of the pixels, the first of them whole, each of later ones planned by
/// what those before took; fills the picture's light, and the report's figures of passes, samples
/// and noise.
void add_passes(GlFrame& frame, const Call& call, Picture& picture, RenderReport& report);

}  // namespace nearfield::render::gpu
