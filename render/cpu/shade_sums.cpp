// SPDX-License-Identifier: Apache-2.0
#include "formats/model/glossy_sum.h"
#include "formats/shared/rng.glsl.h"
#include "render/cpu/lap.h"
#include "render/cpu/shade.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace nearfield::render {
namespace {

constexpr float kBelowOne = 1.0F - 0x1p-24F;

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
    return {glm::dvec3(slab.world_from_slab * u_slab),
            glm::dvec3(sample.weight * (total / energy.y)), glm::dvec3(0.0)};
}

/// Adds one set of points drawn by the energies. is_glossy: with what they reflect to the viewer.
void draw_set(
    const Lamp& lamp, const ShadeQuery& query, int set, bool is_glossy, Scratch& scratch) {
    const int size = query.sets.size_of(set);
    const glm::uvec2 words = glm::uvec2(shift_of_set(query, set, query.seed) * 0x1p24F) << 8U;
    const float start = shared::unit_float(shared::hash4({words.x, words.y, query.seed, 0U}).x);
    const glm::vec3 to_viewer = to_viewer_local(query);
    for (int k = 0; k < size; ++k) {
        const float select = (static_cast<float>(k) + start) / static_cast<float>(size);
        LampPoint point = draw_by_sums(lamp, scratch.energies, std::min(select, kBelowOne),
                                       shared::r2_point(static_cast<std::uint32_t>(k), words));
        if (is_glossy) {
            const glm::dvec3 towards = point.position_world_m - query.hit.position_world_m;
            point.reflected =
                point.weight *
                glm::dvec3(shared::brdf_eval(
                    query.brdf,
                    shared::local_from_world(query.frame, glm::vec3(glm::normalize(towards))),
                    to_viewer));
        }
        scratch.points.push_back(point);
    }
}

/// Sums over one set's points, of which `first` is the first.
SetSums sum_set(const Scratch& scratch, std::size_t first, int size) {
    SetSums result;
    result.count = size;
    for (std::size_t k = first; k < first + static_cast<std::size_t>(size); ++k) {
        const LampPoint& point = scratch.points[k];
        result.all += point.weight;
        result.all_reflected += point.reflected;
        if (scratch.is_visible[k] != 0) {
            result.lit += point.weight;
            result.reflected += point.reflected;
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
    scratch.points.clear();
    for (int set = 0; set < query.sets.sets; ++set)
        draw_set(lamp, query, set, is_glossy, scratch);
    Lap lap;
    scratch.is_visible.clear();
    for (const LampPoint& point : scratch.points)
        scratch.is_visible.push_back(
            is_visible(lamp, tracer, query, point.position_world_m, scratch) ? 1 : 0);
    scratch.shadow_rays_s += lap.time_s();
    scratch.sets.clear();
    std::size_t first = 0;
    for (int set = 0; set < query.sets.sets; ++set) {
        const int size = query.sets.size_of(set);
        scratch.sets.push_back(sum_set(scratch, first, size));
        first += static_cast<std::size_t>(size);
    }
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

/// The sums themselves, without noise.
Estimated without_shadows(glm::vec3 irradiance, glm::vec3 radiance) {
    return {glm::dvec3(irradiance), glm::dvec3(radiance), 0.0};
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
    const glm::vec3 unshadowed = sums.irradiance[index];
    if (!query.has_shadows)
        return light_of(lamp, query, without_shadows(unshadowed, diffuse_of(query) * unshadowed),
                        unshadowed);
    scratch.energies.clear();
    for (const LightSums::OfSlab& slab : sums.slabs) {
        const std::size_t images = slab.image_y.size() / slab.y.size();
        scratch.energies.push_back({slab.receivers[index],
                                    std::span(slab.image_y).subspan(index * images, images),
                                    slab.y[index]});
    }
    trace_sets(lamp, tracer, query, false, scratch);
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
    if (!query.has_shadows)
        return light_of(lamp, query, without_shadows(unshadowed.irradiance, unshadowed.radiance),
                        unshadowed.irradiance);
    trace_sets(lamp, tracer, query, true, scratch);
    return light_of(lamp, query,
                    combine_reflected(scratch.sets, glm::dvec3(unshadowed.irradiance),
                                      glm::dvec3(unshadowed.radiance)),
                    unshadowed.irradiance);
}

}  // namespace nearfield::render
