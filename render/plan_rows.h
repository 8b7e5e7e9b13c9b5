// SPDX-License-Identifier: Apache-2.0
/// What the table of passes (plan.cpp) is made of: whether a scene and its options call for a pass,
/// and about what it holds.
#pragma once

#include "render/plan.h"

#include <glm/glm.hpp>

namespace nearfield::render::rows {

/// What rows of the table decide from.
struct Context {
    const Scene& scene;
    const Lamps& lamps;
    const RenderOptions& options;
    glm::ivec2 size_px;
    const Needs& needs;
    const Plan& plan;  // all but its passes
};

/// A need as the plan decides it.
using Decision = Need;

bool is_on(Switch wanted, const Need& need);

/// The need, or that it was forced.
Decision decide(const char* effect, Switch wanted, const Need& need);

Decision always(const Context& at);
Decision shadows(const Context& at);
Decision shadow_rays(const Context& at);
Decision light_sums(const Context& at);
Decision box_energies(const Context& at);
Decision samples(const Context& at);
Decision gpu_samples(const Context& at);
Decision gloss(const Context& at);
Decision environment(const Context& at);
Decision environment_irradiance(const Context& at);
Decision environment_samples(const Context& at);
Decision environment_rays(const Context& at);
Decision accumulate(const Context& at);
Decision tone_mapping(const Context& at);

// Bytes, about, of what a pass alone holds.
double no_bytes(const Context& at);
double film_bytes(const Context& at);
double camera_bytes(const Context& at);
double coefficient_bytes_of(const Context& at);
double table_bytes_of(const Context& at);
double sampler_bytes(const Context& at);
double g_buffer_bytes(const Context& at);
double shadow_map_bytes(const Context& at);
double energy_bytes(const Context& at);
double sky_map_bytes(const Context& at);
double display_bytes(const Context& at);

}  // namespace nearfield::render::rows
