// SPDX-License-Identifier: Apache-2.0
/// Light that a glossy lobe reflects, by multiple importance sampling: directions drawn by the lamp
/// and directions drawn by the lobe, weighted by the balance heuristic (Veach and Guibas,
/// "Optimally combining sampling techniques for Monte Carlo rendering", 1995). Unbiased for every
/// number of samples if the lamp's sampler is.
#pragma once

#include "render/cpu/shade.h"

namespace nearfield::render {

/// One set of samples of one hit: as many of the lobe as of the lamp.
struct GlossQuery {
    const Lamp& lamp;
    const Tracer& tracer;
    const ShadeQuery& shade;
    const model::SamplerOptions& sampler;  // samples: of this set
    float lamp_total = 0.0F;               // of the views
    glm::vec3 to_viewer{0.0F};             // local
};

/// f_r of the lobe towards a point on the lamp, times the weight of lamp samples there.
glm::dvec3 weighted_lobe(const GlossQuery& query,
                         const model::SamplingView& view,
                         const model::LightSample& sample,
                         glm::dvec3 towards_world);

/// The sum over the set's directions drawn by the lobe. shift: uniform in [0, 1)^2.
glm::dvec3 lobe_samples(const GlossQuery& query, glm::vec2 shift, Scratch& scratch);

}  // namespace nearfield::render
