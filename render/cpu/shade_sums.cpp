// SPDX-License-Identifier: Apache-2.0
#include "formats/model/glossy_sum.h"
#include "formats/shared/rng.glsl.h"
#include "render/cpu/shade.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace nearfield::render {
namespace {

constexpr float kBelowOne = 1.0F - 0x1p-24F;

/// A point on a lamp's U planes, in the world, and its share of the unshadowed irradiance.
struct LampPoint {
    glm::dvec3 position_world_m{0.0};
    glm::vec3 weight{0.0F};
};

/// Draws by energy among the slabs, then within the one drawn. select: uniform in [0, 1).
LampPoint draw_by_sums(const Lamp& lamp,
                       std::span<const SlabEnergy> energies,
                       float select,
                       glm::vec2 xi) {
    float total = 0.0F;
    for (const SlabEnergy& energy : energies)
        total += energy.y;
    float rest = select * total;
    std::size_t s = 0;
    while (s + 1 < energies.size() && (rest >= energies[s].y || energies[s].y <= 0.0F)) {
        rest -= energies[s].y;
        ++s;
    }
    // Rounding may run past the last lit slab.
    while (energies[s].y <= 0.0F)
        --s;
    const SlabEnergy& energy = energies[s];
    const PlacedSlab& slab = lamp.slabs[s];
    const model::ApertureSample sample =
        model::sample_aperture(*slab.prepared, energy.receiver, energy.image_y, energy.y,
                               std::clamp(rest / energy.y, 0.0F, kBelowOne), xi);
    const glm::dvec4 u_slab(glm::dvec2(sample.u_m), -slab.prepared->slab.delta_m, 1.0);
    return {glm::dvec3(slab.world_from_slab * u_slab), sample.weight * (total / energy.y)};
}

/// One set of points drawn by the energies. is_glossy: what they reflect to the viewer is summed
/// too.
SetSums trace_set(const Lamp& lamp,
                  const Tracer& tracer,
                  const ShadeQuery& query,
                  int set,
                  bool is_glossy,
                  Scratch& scratch) {
    const int size = query.sets.size_of(set);
    const glm::uvec2 words = glm::uvec2(shift_of_set(query, set, query.seed) * 0x1p24F) << 8U;
    const float start = shared::unit_float(shared::hash4({words.x, words.y, query.seed, 0U}).x);
    const glm::vec3 to_viewer = to_viewer_local(query);
    SetSums result;
    result.count = size;
    for (int k = 0; k < size; ++k) {
        const float select = (static_cast<float>(k) + start) / static_cast<float>(size);
        const LampPoint point =
            draw_by_sums(lamp, scratch.energies, std::min(select, kBelowOne),
                         shared::r2_point(static_cast<std::uint32_t>(k), words));
        const glm::dvec3 weight(point.weight);
        glm::dvec3 reflected(0.0);
        if (is_glossy) {
            const glm::dvec3 towards = point.position_world_m - query.hit.position_world_m;
            reflected =
                weight *
                glm::dvec3(shared::brdf_eval(
                    query.brdf,
                    shared::local_from_world(query.frame, glm::vec3(glm::normalize(towards))),
                    to_viewer));
        }
        result.all += weight;
        result.all_reflected += reflected;
        if (is_visible(lamp, tracer, query.hit, point.position_world_m, scratch)) {
            result.lit += weight;
            result.reflected += reflected;
            result.visible += 1.0;
        }
    }
    return result;
}

void trace_sets(const Lamp& lamp,
                const Tracer& tracer,
                const ShadeQuery& query,
                bool is_glossy,
                Scratch& scratch) {
    scratch.sets.clear();
    for (int set = 0; set < query.sets.sets; ++set)
        scratch.sets.push_back(trace_set(lamp, tracer, query, set, is_glossy, scratch));
}

/// The surface in one slab's frame.
model::GlossyReceiver glossy_receiver(const PlacedSlab& slab, const ShadeQuery& query) {
    const glm::mat3 turn(slab.slab_from_world_rotation);
    model::GlossyReceiver receiver;
    receiver.position_m = receiver_in_slab(slab, query.hit).position_m;
    receiver.frame = {turn * query.frame.x, turn * query.frame.y, turn * query.frame.z};
    receiver.brdf = query.brdf;
    receiver.to_viewer_local = to_viewer_local(query);
    return receiver;
}

// Of a window's narrower side: below that images differ by what part of a texel they see, and the
// sum's error is above what glossy_sum.h says.
constexpr double kFewestTexels = 4.0;

/// What a basis function shows of S to a receiver at height z, on the narrower side.
double texels_per_window(const Slab& slab, float z_m) {
    const auto z = static_cast<double>(z_m);
    const glm::dvec2 window_m = slab.pitch_m * static_cast<double>(slab.profile.cells.size()) *
                                std::abs(z / (z + slab.delta_m));
    const glm::dvec2 texels = window_m / slab.texel_m();
    return std::min(texels.x, texels.y);
}

}  // namespace

LampLight shade_diffuse(const Lamp& lamp,
                        const Tracer& tracer,
                        const ShadeQuery& query,
                        const LightSums& sums,
                        std::size_t index,
                        Scratch& scratch) {
    if (!(sums.total_y[index] > 0.0F))
        return {};
    scratch.energies.clear();
    for (const LightSums::OfSlab& slab : sums.slabs) {
        const std::size_t images = slab.image_y.size() / slab.y.size();
        scratch.energies.push_back({slab.receivers[index],
                                    std::span(slab.image_y).subspan(index * images, images),
                                    slab.y[index]});
    }
    trace_sets(lamp, tracer, query, false, scratch);
    const glm::vec3 unshadowed = sums.irradiance[index];
    return light_of(
        lamp, query,
        combine_ratio(scratch.sets, glm::dvec3(diffuse_of(query)), glm::dvec3(unshadowed)),
        unshadowed);
}

bool resolves_lobe(const Lamp& lamp, const ShadeQuery& query) {
    return std::all_of(lamp.slabs.begin(), lamp.slabs.end(), [&](const PlacedSlab& slab) {
        const model::GlossyReceiver receiver = glossy_receiver(slab, query);
        return texels_per_window(slab.prepared->slab, receiver.position_m.z) >= kFewestTexels &&
               model::texels_resolve_lobe(slab.prepared->slab, receiver);
    });
}

LampLight shade_reflected(const Lamp& lamp,
                          const Tracer& tracer,
                          const ShadeQuery& query,
                          Scratch& scratch) {
    scratch.energies.clear();
    scratch.image_y.resize(lamp.slabs.size());
    model::Reflected unshadowed;
    float total = 0.0F;
    for (std::size_t s = 0; s < lamp.slabs.size(); ++s) {
        const PlacedSlab& slab = lamp.slabs[s];
        std::vector<float>& image_y = scratch.image_y[s];
        image_y.resize(static_cast<std::size_t>(slab.prepared->slab.image_count()));
        const model::Reflected of_slab =
            model::reflect_light(*slab.prepared, glossy_receiver(slab, query), image_y);
        unshadowed.irradiance += of_slab.irradiance;
        unshadowed.radiance += of_slab.radiance;
        float y = 0.0F;
        for (const float of_image : image_y)
            y += of_image;
        scratch.energies.push_back({receiver_in_slab(slab, query.hit), image_y, y});
        total += y;
    }
    if (!(total > 0.0F))
        return {};
    trace_sets(lamp, tracer, query, true, scratch);
    return light_of(lamp, query,
                    combine_reflected(scratch.sets, glm::dvec3(unshadowed.irradiance),
                                      glm::dvec3(unshadowed.radiance)),
                    unshadowed.irradiance);
}

}  // namespace nearfield::render
