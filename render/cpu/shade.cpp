// SPDX-License-Identifier: Apache-2.0
#include "formats/model/luminaire.h"
#include "formats/shared/brdf.glsl.h"
#include "formats/shared/rng.glsl.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/lamps.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

using shared::luminance709;

model::ReceiverF receiver_in_slab(const PlacedSlab& slab, const Hit& hit) {
    return {glm::vec3(slab.slab_from_world * glm::dvec4(hit.position_world_m, 1.0)),
            glm::vec3(slab.slab_from_world_rotation * hit.shading_normal)};
}

/// A point on a lamp's U planes, in the world, and its share of the unshadowed irradiance.
struct LampSample {
    glm::dvec3 position_world_m{0.0};
    glm::vec3 weight{0.0F};
};

/// Draws by energy among the slabs, then within the one drawn. select: uniform in [0, 1).
LampSample draw(
    const Lamp& lamp, const LightSums& sums, std::size_t index, float select, glm::vec2 xi) {
    const float total_y = sums.total_y[index];
    const auto slab_y = [&](std::size_t slab) { return sums.slabs[slab].y[index]; };
    float rest = select * total_y;
    std::size_t s = 0;
    while (s + 1 < lamp.slabs.size() && (rest >= slab_y(s) || slab_y(s) <= 0.0F)) {
        rest -= slab_y(s);
        ++s;
    }
    // Rounding may run past the last lit slab.
    while (slab_y(s) <= 0.0F)
        --s;
    constexpr float kBelowOne = 1.0F - 0x1p-24F;
    const PlacedSlab& slab = lamp.slabs[s];
    const LightSums::OfSlab& light = sums.slabs[s];
    const auto images = static_cast<std::size_t>(slab.prepared->slab.image_count());
    const model::ApertureSample sample =
        model::sample_aperture(*slab.prepared, light.receivers[index],
                               std::span(light.image_y).subspan(index * images, images), slab_y(s),
                               std::clamp(rest / slab_y(s), 0.0F, kBelowOne), xi);
    const glm::dvec4 u_slab(glm::dvec2(sample.u_m), -slab.prepared->slab.delta_m, 1.0);
    return {glm::dvec3(slab.world_from_slab * u_slab), sample.weight * (total_y / slab_y(s))};
}

void trace_samples(const Lamp& lamp,
                   const Tracer& tracer,
                   const ShadeQuery& query,
                   const LightSums& sums,
                   std::size_t index,
                   Scratch& scratch) {
    const auto count = static_cast<std::size_t>(query.samples);
    scratch.weights.resize(count);
    scratch.lobes.resize(count);
    scratch.visible.resize(count);
    const Hit& hit = query.hit;
    const glm::dvec3 origin = hit.position_world_m + hit.geometric_normal * hit.offset_m;
    const glm::uvec4 random = shared::hash4({query.key.x, query.key.y, query.seed, 0U});
    const bool is_glossy = glm::any(glm::greaterThan(query.reflectance.specular, glm::vec3(0.0F)));
    for (std::size_t k = 0; k < count; ++k) {
        const float select =
            (static_cast<float>(k) + shared::unit_float(random.x)) / static_cast<float>(count);
        const LampSample sample =
            draw(lamp, sums, index, std::min(select, 1.0F - 0x1p-24F),
                 shared::r2_point(static_cast<std::uint32_t>(k), {random.y, random.z}));
        const glm::dvec3 towards = sample.position_world_m - hit.position_world_m;
        scratch.weights[k] = sample.weight;
        bool is_visible = glm::dot(towards, hit.geometric_normal) > 0.0;
        if (is_visible) {
            is_visible = !tracer.is_occluded(origin, sample.position_world_m, lamp.mask);
            ++scratch.shadow_rays;
        }
        scratch.visible[k] = is_visible;
        scratch.lobes[k] =
            is_visible && is_glossy
                ? shared::phong_lobe(glm::vec3(hit.shading_normal),
                                     glm::vec3(glm::normalize(towards)),
                                     glm::vec3(query.to_viewer_world), query.reflectance.exponent)
                : 0.0F;
    }
}

/// The ratio estimator, channel by channel: sum of weight * value over sum of weight.
template <typename Value>
glm::dvec3 weighted_mean(const std::vector<glm::vec3>& weights, const Value& value) {
    glm::dvec3 top(0.0), bottom(0.0);
    double plain = 0.0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
        top += glm::dvec3(weights[k]) * value(k);
        bottom += glm::dvec3(weights[k]);
        plain += value(k);
    }
    // A channel in which no sample carries light: take the samples as they fell.
    glm::dvec3 mean(plain / static_cast<double>(weights.size()));
    for (int c = 0; c < 3; ++c)
        if (bottom[c] > 0.0)
            mean[c] = top[c] / bottom[c];
    return mean;
}

/// Sampling sigma of radiance Y: with r_k = E g_k (rho_k V_k - mean) / sum g, the first-order
/// deviation that sample k causes, sqrt(K / (K - 1) sum r_k^2). Samples count as independent, which
/// stratified ones beat.
float sampling_sigma_y(const ShadeQuery& query,
                       const Scratch& scratch,
                       glm::vec3 irradiance,
                       glm::dvec3 mean_visibility,
                       glm::dvec3 mean_lobe) {
    glm::dvec3 bottom(0.0);
    for (const glm::vec3& weight : scratch.weights)
        bottom += glm::dvec3(weight);
    const glm::dvec3 diffuse(query.reflectance.diffuse * shared::kInversePi);
    const glm::dvec3 specular(query.reflectance.specular);
    const glm::dvec3 scale = glm::dvec3(irradiance) / glm::max(bottom, glm::dvec3(1e-300));
    double squares = 0.0;
    for (std::size_t k = 0; k < scratch.weights.size(); ++k) {
        const double visible = scratch.visible[k] ? 1.0 : 0.0;
        const glm::dvec3 deviation = diffuse * (visible - mean_visibility) +
                                     specular * (static_cast<double>(scratch.lobes[k]) - mean_lobe);
        const glm::dvec3 r = scale * glm::dvec3(scratch.weights[k]) * deviation;
        const double y = 0.2126 * r.x + 0.7152 * r.y + 0.0722 * r.z;
        squares += y * y;
    }
    const auto count = static_cast<double>(scratch.weights.size());
    return static_cast<float>(std::sqrt(count / (count - 1.0) * squares));
}

// The light field's own sigma of irradiance, times what turns irradiance into diffuse radiance.
float measured_sigma_y(const Lamp& lamp, const Hit& hit, glm::vec3 unshadowed, glm::vec3 diffuse) {
    const double sigma_y = model::irradiance_sigma_y(
        *lamp.measured,
        {glm::dvec3(lamp.luminaire_from_world * glm::dvec4(hit.position_world_m, 1.0)),
         lamp.luminaire_from_world_rotation * hit.shading_normal});
    return static_cast<float>(sigma_y) * luminance709(diffuse) / luminance709(unshadowed);
}

}  // namespace

void sum_light(const Lamp& lamp, std::span<const Hit> hits, LightSums& sums) {
    sums.slabs.resize(lamp.slabs.size());
    sums.irradiance.assign(hits.size(), glm::vec3(0.0F));
    sums.total_y.assign(hits.size(), 0.0F);
    sums.of_one_slab.resize(hits.size());
    sums.multiply_adds = 0;
    for (std::size_t s = 0; s < lamp.slabs.size(); ++s) {
        const model::PreparedSlab& prepared = *lamp.slabs[s].prepared;
        const auto images = static_cast<std::size_t>(prepared.slab.image_count());
        LightSums::OfSlab& slab = sums.slabs[s];
        slab.receivers.clear();
        for (const Hit& hit : hits)
            slab.receivers.push_back(receiver_in_slab(lamp.slabs[s], hit));
        slab.image_y.resize(hits.size() * images);
        sums.multiply_adds +=
            model::irradiance(prepared, slab.receivers, sums.of_one_slab, slab.image_y);
        slab.y.assign(hits.size(), 0.0F);
        for (std::size_t h = 0; h < hits.size(); ++h) {
            sums.irradiance[h] += sums.of_one_slab[h];
            for (std::size_t m = 0; m < images; ++m)
                slab.y[h] += slab.image_y[h * images + m];
            sums.total_y[h] += slab.y[h];
        }
    }
}

LampLight shade(const Lamp& lamp,
                const Tracer& tracer,
                const ShadeQuery& query,
                const LightSums& sums,
                std::size_t index,
                Scratch& scratch) {
    LampLight light;
    if (!(sums.total_y[index] > 0.0F))
        return light;

    trace_samples(lamp, tracer, query, sums, index, scratch);
    const glm::vec3 unshadowed = sums.irradiance[index] * lamp.dim;
    const glm::dvec3 visibility = weighted_mean(
        scratch.weights, [&](std::size_t k) { return scratch.visible[k] ? 1.0 : 0.0; });
    const glm::dvec3 lobe = weighted_mean(
        scratch.weights, [&](std::size_t k) { return static_cast<double>(scratch.lobes[k]); });
    light.irradiance = unshadowed * glm::vec3(visibility);
    const glm::vec3 diffuse = light.irradiance * query.reflectance.diffuse * shared::kInversePi;
    light.radiance = diffuse + unshadowed * query.reflectance.specular * glm::vec3(lobe);
    light.sigma_y = sampling_sigma_y(query, scratch, unshadowed, visibility, lobe);
    if (lamp.measured && luminance709(diffuse) > 0.0F)
        light.sigma_measured_y = measured_sigma_y(lamp, query.hit, sums.irradiance[index], diffuse);
    return light;
}

}  // namespace nearfield::render
