// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/gloss.h"

#include "formats/shared/rng.glsl.h"

namespace nearfield::render {
namespace {

constexpr float kWordsPerUnit = 0x1p24F;  // a shift has 24 bits

/// The balance heuristic for two ways that draw equally many samples.
double balance(double density, double other) {
    return density / (density + other);
}

/// Where a ray from the receiver meets U, in the slab's frame; false where it never does.
struct Meeting {
    bool is_met = false;
    glm::vec2 u_m{0.0F};
};
Meeting meet_u(const Slab& slab, glm::vec3 p_m, glm::vec3 direction) {
    const float height = static_cast<float>(slab.delta_m) + p_m.z;
    if (!(height > 0.0F && direction.z < 0.0F))
        return {};
    return {true, glm::vec2(p_m) - glm::vec2(direction) * (height / direction.z)};
}

/// Of one direction: light that the lobe reflects from all slabs, weighted, over the density.
glm::dvec3 along(const GlossQuery& query,
                 glm::vec3 to_light,
                 float lobe_density,
                 Scratch& scratch) {
    const glm::dvec3 direction(shared::world_from_local(query.shade.frame, to_light));
    const glm::dvec3 lobe(shared::brdf_lobe(query.shade.brdf, to_light, query.to_viewer));
    glm::dvec3 sum(0.0);
    for (std::size_t s = 0; s < query.lamp.slabs.size(); ++s) {
        const PlacedSlab& slab = query.lamp.slabs[s];
        const model::SamplingView& view = scratch.views[s];
        if (!(view.total > 0.0F))
            continue;
        const Meeting met = meet_u(slab.prepared->slab, view.receiver.position_m,
                                   glm::vec3(slab.slab_from_world_rotation * direction));
        if (!met.is_met)
            continue;
        const glm::vec3 radiance =
            model::radiance_towards(*slab.prepared, view.receiver.position_m, met.u_m);
        if (!glm::any(glm::greaterThan(radiance, glm::vec3(0.0F))))
            continue;
        const glm::dvec4 u_slab(glm::dvec2(met.u_m), -slab.prepared->slab.delta_m, 1.0);
        if (!is_visible(query.lamp, query.tracer, query.shade,
                        glm::dvec3(slab.world_from_slab * u_slab), scratch))
            continue;
        const float light_density = model::marginal_density_omega(
            query.lamp.file->sampling[s], view, query.sampler, query.lamp_total, met.u_m);
        const double weight =
            balance(static_cast<double>(lobe_density), static_cast<double>(light_density));
        sum += glm::dvec3(radiance) * lobe *
               (weight * static_cast<double>(to_light.z) / static_cast<double>(lobe_density));
    }
    return sum;
}

}  // namespace

glm::dvec3 weighted_lobe(const GlossQuery& query,
                         const model::SamplingView& view,
                         const model::LightSample& sample,
                         glm::dvec3 towards_world) {
    const glm::vec3 to_light =
        shared::local_from_world(query.shade.frame, glm::vec3(glm::normalize(towards_world)));
    const auto slab = static_cast<std::size_t>(sample.slab);
    const auto light_density = static_cast<double>(model::marginal_density_omega(
        query.lamp.file->sampling[slab], view, query.sampler, query.lamp_total, sample.u_m));
    const auto lobe_density =
        static_cast<double>(shared::brdf_lobe_density(query.shade.brdf, to_light, query.to_viewer));
    if (!(light_density > 0.0))
        return glm::dvec3(0.0);
    return glm::dvec3(shared::brdf_lobe(query.shade.brdf, to_light, query.to_viewer)) *
           balance(light_density, lobe_density);
}

glm::dvec3 lobe_samples(const GlossQuery& query, glm::vec2 shift, Scratch& scratch) {
    const glm::uvec2 words = glm::uvec2(shift * kWordsPerUnit) << 8U;
    glm::dvec3 sum(0.0);
    for (int k = 0; k < query.sampler.samples; ++k) {
        const glm::vec2 xi = shared::r2_point(static_cast<std::uint32_t>(k), words);
        const glm::vec3 to_light = shared::brdf_lobe_sample(query.shade.brdf, query.to_viewer, xi);
        const float density =
            shared::brdf_lobe_density(query.shade.brdf, to_light, query.to_viewer);
        if (density > 0.0F)
            sum += along(query, to_light, density, scratch);
    }
    return sum;
}

}  // namespace nearfield::render
