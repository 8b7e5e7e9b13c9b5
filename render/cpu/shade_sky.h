// SPDX-License-Identifier: Apache-2.0
/// The light of the environment at one camera hit. Where the query has no shadows everything lets
/// light pass.
#pragma once

#include "render/cpu/shade.h"
#include "render/sky.h"

namespace nearfield::render {

struct SkyQuery {
    const Sky& sky;
    const Tracer& tracer;
    const ShadeQuery& shade;
    const EnvironmentOptions& options;
    float turn_rad = 0.0F;        // of the normal across the pixel
    float camera_samples = 1.0F;  // of the pixel
};

/// Diffuse part by spherical harmonics, lobe by filtered samples (filtered_samples.glsl.h), the
/// same ones for every hit: no noise, a bias. Both lack what harmonics say of the sky that is
/// hidden, by rays in few directions that hold most of its light (visibility_fit.h).
LampLight shade_sky_filtered(const SkyQuery& query, Scratch& scratch);

/// By the sky's few directions as far lamps.
LampLight shade_sky_lights(const SkyQuery& query, Scratch& scratch);

/// Samples of the sky by luminance and as many of the BRDF, combined by the balance heuristic:
/// unbiased.
LampLight shade_sky_reference(const SkyQuery& query, Scratch& scratch);

/// Of 8 times as many candidates, drawn in the same two ways, so many are kept in proportion to the
/// light that they would reflect if visible (Burke, Ghosh, Heidrich, "Bidirectional importance
/// sampling for direct illumination", 2005; Talbot et al. 2005).
LampLight shade_sky_resampled(const SkyQuery& query, Scratch& scratch);

// What they share.

/// Whether the sky is visible in a direction in the world; counts the ray where there is one.
bool is_open(const SkyQuery& query, glm::vec3 direction_world, Scratch& scratch);

}  // namespace nearfield::render
