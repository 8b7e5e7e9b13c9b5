// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/draw.glsl.h"
#include "render/cpu/gloss.h"
#include "render/cpu/lap.h"
#include "render/cpu/shade.h"

#include <algorithm>

namespace nearfield::render {
namespace {

glm::dvec3 position_world_m(const Lamp& lamp, const model::LightSample& sample) {
    const PlacedSlab& slab = lamp.slabs[static_cast<std::size_t>(sample.slab)];
    const glm::dvec4 u_slab(glm::dvec2(sample.u_m), -slab.prepared->slab.delta_m, 1.0);
    return {slab.world_from_slab * u_slab};
}

/// Which of the lamp's samples are visible.
void trace_samples(const GlossQuery& gloss, Scratch& scratch) {
    Lap lap;
    scratch.is_visible.clear();
    for (const model::LightSample& sample : scratch.samples)
        scratch.is_visible.push_back(is_visible(gloss.lamp, gloss.tracer, gloss.shade,
                                                position_world_m(gloss.lamp, sample), scratch)
                                         ? 1
                                         : 0);
    scratch.shadow_rays_s += lap.time_s();
}

/// One set of the lamp's samples, and of the lobe's where the surface is glossy.
SetSums sample_set(const GlossQuery& gloss, int set, Scratch& scratch) {
    const ShadeQuery& query = gloss.shade;
    model::draw(gloss.lamp.file->sampling, scratch.views, gloss.sampler,
                shift_of_set(query, set, query.seed), scratch.samples);
    trace_samples(gloss, scratch);
    const bool is_glossy = shared::brdf_is_glossy(query.brdf);
    SetSums result;
    for (std::size_t k = 0; k < scratch.samples.size(); ++k) {
        const model::LightSample& sample = scratch.samples[k];
        const glm::dvec3 light(sample.light);
        result.all += light;
        if (scratch.is_visible[k] == 0)
            continue;
        result.lit += light;
        result.visible += 1.0;
        if (is_glossy)
            result.reflected +=
                light *
                weighted_lobe(gloss, scratch.views[static_cast<std::size_t>(sample.slab)], sample,
                              position_world_m(gloss.lamp, sample) - query.hit.position_world_m);
    }
    // A sampler's samples sum to the estimate, the lobe's have it as their mean; sets pool by size.
    const double size = gloss.sampler.samples;
    const double drawn = std::max<double>(static_cast<double>(scratch.samples.size()), 1.0);
    result.count = size;
    result.visible *= size / drawn;
    result.lit *= size;
    result.all *= size;
    result.reflected *= size;
    if (is_glossy)
        result.reflected +=
            lobe_samples(gloss, shift_of_set(query, set, query.seed ^ shared::kLobeSeed), scratch);
    return result;
}

}  // namespace

LampLight shade_sampled(const Lamp& lamp,
                        const Tracer& tracer,
                        const ShadeQuery& query,
                        const model::SamplerOptions& sampler,
                        const LightSums* sums,
                        std::size_t index,
                        Scratch& scratch) {
    scratch.views.resize(lamp.slabs.size());
    model::SamplerOptions of_set = sampler;
    of_set.samples = query.sets.size_of(0);
    float total = 0.0F;
    for (std::size_t s = 0; s < lamp.slabs.size(); ++s) {
        model::look(lamp.file->sampling[s], receiver_in_slab(lamp.slabs[s], query.hit), of_set,
                    scratch.views[s]);
        total += scratch.views[s].total;
    }
    if (!(total > 0.0F))
        return {};
    scratch.sets.clear();
    for (int set = 0; set < query.sets.sets; ++set) {
        of_set.samples = query.sets.size_of(set);
        const GlossQuery gloss{lamp, tracer, query, of_set, total, to_viewer_local(query)};
        scratch.sets.push_back(sample_set(gloss, set, scratch));
    }
    const glm::vec3 diffuse = diffuse_of(query);
    const Estimated estimate = sums != nullptr ? combine_ratio(scratch.sets, glm::dvec3(diffuse),
                                                               glm::dvec3(sums->irradiance[index]))
                                               : combine_means(scratch.sets, glm::dvec3(diffuse));
    SetSums all;
    for (const SetSums& set : scratch.sets) {
        all.all += set.all;
        all.count += set.count;
    }
    const glm::vec3 unshadowed =
        sums != nullptr ? sums->irradiance[index] : glm::vec3(all.all / all.count);
    return light_of(lamp, query, estimate, unshadowed);
}

}  // namespace nearfield::render
