// SPDX-License-Identifier: Apache-2.0
/// The environment's light on the graphics card: as render/cpu/shade_sky.h, with maps in place of
/// rays. Samples with a ray each are the CPU's.
#pragma once

#include "render/gpu/film.h"
#include "render/gpu/shader.h"
#include "render/gpu/sky_maps.h"
#include "render/gpu/sky_textures.h"
#include "render/gpu/surfaces.h"
#include "render/options.h"
#include "render/plan.h"

#include <cstdint>

namespace nearfield::render::gpu {

/// What programs are compiled for.
struct SkyVariant {
    bool has_irradiance = false, has_samples = false, has_lights = false, has_shadows = false;
    bool has_tangents = false, is_anisotropic = false, is_shifted = false;
    bool is_smoothed = false;                    // what is hidden, over neighbors
    bool has_counts = false, has_turns = false;  // sample_count.glsl.h; HAS_TURNS of surfaces
    FilterLevel level = FilterLevel::Fis;

    bool operator==(const SkyVariant&) const = default;
};

/// Programs and targets of the plan's passes, and none of others.
struct SkyPasses {
    SkyVariant variant;
    Program past, irradiance, samples, lights, visibility, smoothing;
    glm::ivec2 size_px{0};
    // RGBA32F arrays of 4: 16 coefficients a pixel; only with shadows. `found` before it is
    // smoothed.
    Texture hidden, found;
    Texture shift;  // RG32F: only where samples are shifted
    std::uint64_t bytes = 0;
};

/// What a scene's environment keeps on the card from frame to frame.
struct SkyKept {
    SkyOnCard on_card;
    SkyMapPass map_pass;
    SkyMaps maps;
    SkyPasses passes;
};

/// Uploads, compiles and renders maps where something has changed. Throws Error where the method is
/// one of the CPU's, or the environment passes the device's limits.
void prepare_sky(Device& device,
                 const Sky& sky,
                 const Plan& plan,
                 const RenderOptions& options,
                 const SceneBuffers& scene,
                 glm::ivec2 size_px,
                 SkyKept& kept);

/// Adds its light at the surfaces that are bound to the film's lamp_light and lamp_irradiance.
/// camera_sample: counted through all of a pixel's; random shifts depend on it.
void add_sky_light(Device& device,
                   const RenderOptions& options,
                   std::uint32_t camera_sample,
                   const SkyKept& kept);

}  // namespace nearfield::render::gpu
