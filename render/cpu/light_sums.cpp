// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/light_sums.h"

#include "formats/shared/tonemap.glsl.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

std::uint64_t irradiance(const PlacedSlab& slab,
                         int q,
                         std::span<const model::ReceiverF> receivers,
                         std::span<glm::vec3> results,
                         std::span<float> image_y) {
    return q == 0 ? model::irradiance(*slab.prepared, receivers, results, image_y)
                  : model::irradiance(*slab.mips, q, receivers, results, image_y);
}

// Adds what it costs to the sums' multiply-adds.
float bias_bound_rel(const Lamp& lamp, int q, LightSums& sums) {
    const auto brightest = static_cast<std::size_t>(
        std::max_element(sums.total_y.begin(), sums.total_y.end()) - sums.total_y.begin());
    const float y = shared::luminance709(sums.irradiance[brightest]);
    if (!(y > 0.0F))
        return 0.0F;
    glm::vec3 finer(0.0F), of_slab(0.0F);
    for (std::size_t s = 0; s < lamp.slabs.size(); ++s) {
        sums.multiply_adds += irradiance(
            lamp.slabs[s], 2 * q, {&sums.slabs[s].receivers[brightest], 1}, {&of_slab, 1}, {});
        finer += of_slab;
    }
    return model::kBiasPerDifference * std::abs(shared::luminance709(finer) - y) / y;
}

}  // namespace

model::ReceiverF receiver_in_slab(const PlacedSlab& slab, const Hit& hit) {
    return {glm::vec3(slab.slab_from_world * glm::dvec4(hit.position_world_m, 1.0)),
            glm::vec3(slab.slab_from_world_rotation * hit.shading_normal)};
}

void sum_light(const Lamp& lamp, int q, std::span<const Hit> hits, LightSums& sums) {
    sums.slabs.resize(lamp.slabs.size());
    sums.irradiance.assign(hits.size(), glm::vec3(0.0F));
    sums.total_y.assign(hits.size(), 0.0F);
    sums.of_one_slab.resize(hits.size());
    sums.multiply_adds = 0;
    for (std::size_t s = 0; s < lamp.slabs.size(); ++s) {
        const PlacedSlab& placed = lamp.slabs[s];
        const auto images = static_cast<std::size_t>(placed.prepared->slab.image_count());
        LightSums::OfSlab& slab = sums.slabs[s];
        slab.receivers.clear();
        for (const Hit& hit : hits)
            slab.receivers.push_back(receiver_in_slab(placed, hit));
        slab.image_y.resize(hits.size() * images);
        sums.multiply_adds += irradiance(placed, q, slab.receivers, sums.of_one_slab, slab.image_y);
        slab.y.assign(hits.size(), 0.0F);
        for (std::size_t h = 0; h < hits.size(); ++h) {
            sums.irradiance[h] += sums.of_one_slab[h];
            for (std::size_t m = 0; m < images; ++m)
                slab.y[h] += slab.image_y[h * images + m];
            sums.total_y[h] += slab.y[h];
        }
    }
    sums.bias_bound_rel = q > 0 ? bias_bound_rel(lamp, q, sums) : 0.0F;
}

}  // namespace nearfield::render
