// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/lamps.h"

#include <algorithm>
#include <utility>

namespace nearfield::render::gpu {
namespace {

bool has_sums(const RenderOptions& options) {
    return !options.sampler.has_value();
}

bool has_cdfs(const RenderOptions& options) {
    return options.sampler == model::Sampler::Pdis ||
           options.sampler == model::Sampler::Precomputed;
}

bool has_samples(const Plan& plan, const RenderOptions& options) {
    return options.sampler.has_value() || plan.has_gloss;
}

model::Sampler sampler_of(const RenderOptions& options) {
    return options.sampler.value_or(model::Sampler::Systematic);
}

SlabPlacement placement_of(const PlacedSlab& slab) {
    return {slab.slab_from_world, slab.world_from_slab, slab.slab_from_world_rotation};
}

SumSlab upload_sums(Device& device, const PlacedSlab& slab, const Plan& plan) {
    const bool has_color = plan.color.is_in;
    return slab.mips != nullptr
               ? upload_sum_slab(device, *slab.mips, has_color, placement_of(slab))
               : upload_sum_slab(device, *slab.prepared, has_color, placement_of(slab));
}

SlabTextures upload_tables(Device& device,
                           const PlacedSlab& slab,
                           const SlabTables& tables,
                           const Plan& plan,
                           const RenderOptions& options) {
    SlabNeeds needs;
    needs.tables = true;
    needs.cdfs = has_cdfs(options);
    needs.has_color = plan.color.is_in;
    return upload_slab(device, slab.prepared->slab, slab.prepared->lit, &tables, needs,
                       placement_of(slab));
}

void upload_file(Device& device,
                 const Lamp& lamp,
                 const Plan& plan,
                 const RenderOptions& options,
                 LampsOnCard& on_card) {
    FileOnCard& file = on_card.files[lamp.file.get()];
    file.file = lamp.file;
    const std::uint64_t before = device.allocated_bytes();
    for (std::size_t s = file.sums.size(); has_sums(options) && s < lamp.slabs.size(); ++s)
        file.sums.push_back(upload_sums(device, lamp.slabs[s], plan));
    const std::uint64_t between = device.allocated_bytes();
    for (std::size_t s = file.sampled.size(); has_samples(plan, options) && s < lamp.slabs.size();
         ++s)
        file.sampled.push_back(
            upload_tables(device, lamp.slabs[s], lamp.file->sampling[s].tables, plan, options));
    file.sum_bytes += between - before;
    file.table_bytes += device.allocated_bytes() - between;
}

LightSamples make_samples(Device& device,
                          const Plan& plan,
                          const RenderOptions& options,
                          bool has_shadows,
                          bool has_tangents) {
    SampleNeeds needs;
    needs.sampler = sampler_of(options);
    needs.sequence = options.sequence.value_or(model::default_sequence(needs.sampler));
    needs.shift = options.shift;
    needs.has_color = plan.color.is_in;
    needs.has_shadows = has_shadows;
    needs.has_gloss = plan.has_gloss;
    needs.gloss_only = has_sums(options);
    needs.has_tangents = has_tangents;
    if (has_shadows)
        needs.more_defines = shadow_defines(options.shadow_maps);
    return make_light_samples(device, needs);
}

}  // namespace

void upload_lamps(Device& device,
                  const Lamps& lamps,
                  const Plan& plan,
                  const RenderOptions& options,
                  LampsOnCard& on_card) {
    const bool is_of_other_kind = on_card.has_color != plan.color.is_in ||
                                  (on_card.has_cdfs != has_cdfs(options) && options.sampler);
    std::erase_if(on_card.files, [&](const auto& file) {
        return is_of_other_kind ||
               std::none_of(lamps.lamps.begin(), lamps.lamps.end(),
                            [&](const Lamp& lamp) { return lamp.file.get() == file.first; });
    });
    on_card.has_color = plan.color.is_in;
    on_card.has_cdfs = has_cdfs(options);
    for (std::size_t k = 0; k < lamps.lamps.size(); ++k)
        if (plan.lamps[k].is_lit)
            upload_file(device, lamps.lamps[k], plan, options, on_card);
    on_card.sum_bytes = on_card.table_bytes = 0;
    for (const auto& [key, file] : on_card.files) {
        on_card.sum_bytes += file.sum_bytes;
        on_card.table_bytes += file.table_bytes;
    }
    on_card.shadows.resize(lamps.lamps.size());
}

LightPasses make_light_passes(Device& device,
                              const Plan& plan,
                              const RenderOptions& options,
                              bool has_tangents) {
    LightPasses passes;
    passes.sums.shadows =
        options.shadow_weights == ShadowWeights::Pdis ? SumShadows::Pdis : SumShadows::Shares;
    passes.sums.more_defines = shadow_defines(options.shadow_maps);
    const auto any_lit = [&](bool has_shadows) {
        return std::any_of(plan.lamps.begin(), plan.lamps.end(), [&](const LampPlan& lamp) {
            return lamp.is_lit && lamp.has_shadows == has_shadows;
        });
    };
    if (has_samples(plan, options)) {
        if (any_lit(true))
            passes.samples = make_samples(device, plan, options, true, has_tangents);
        if (any_lit(false))
            passes.unshadowed_samples = make_samples(device, plan, options, false, has_tangents);
    }
    return passes;
}

void add_sums(
    Device& device, LightPasses& passes, LampsOnCard& on_card, const LampPass& pass, int q) {
    if (!has_sums(pass.options))
        return;
    const Lamp& lamp = pass.lamps.lamps[pass.lamp];
    const bool has_shadows = pass.plan.lamps[pass.lamp].has_shadows;
    const std::vector<SumSlab>& sums = on_card.files.at(lamp.file.get()).sums;
    for (std::size_t s = 0; s < sums.size(); ++s) {
        for (const SlabTextures& level : sums[s].levels)
            place_slab(level, placement_of(lamp.slabs[s]));
        device.run_pass("light sums", [&] {
            if (has_shadows)
                bind_shadows(on_card.shadows[pass.lamp], s);
            add_light_sum(device, has_shadows ? passes.sums : passes.unshadowed_sums, sums[s], q,
                          lamp.dim, pass.query.size_px);
        });
    }
}

void add_samples(Device& device, LightPasses& passes, LampsOnCard& on_card, const LampPass& pass) {
    if (!has_samples(pass.plan, pass.options))
        return;
    const Lamp& lamp = pass.lamps.lamps[pass.lamp];
    const bool has_shadows = pass.plan.lamps[pass.lamp].has_shadows;
    const ShadowMaps& maps = on_card.shadows[pass.lamp];
    const std::vector<SlabTextures>& textures = on_card.files.at(lamp.file.get()).sampled;
    std::vector<SampledSlab> slabs;
    for (std::size_t s = 0; s < textures.size(); ++s) {
        place_slab(textures[s], placement_of(lamp.slabs[s]));
        SampledSlab slab{&textures[s], &lamp.slabs[s].prepared->slab, {}};
        if (has_shadows)
            slab.bind_shadows = [&maps, s] { bind_shadows(maps, s); };
        slabs.push_back(std::move(slab));
    }
    SampleQuery query = pass.query;
    query.dim = lamp.dim;
    add_light_samples(device, has_shadows ? passes.samples : passes.unshadowed_samples, slabs,
                      query);
}

int count_unmapped(Device& device,
                   const Surfaces& surfaces,
                   const Buffer& materials,
                   const LampsOnCard& on_card,
                   const LampPass& pass,
                   LightPasses& passes) {
    const Lamp& lamp = pass.lamps.lamps[pass.lamp];
    if (!pass.plan.lamps[pass.lamp].has_shadows)
        return 0;
    if (!passes.unmapped)
        passes.unmapped = link_unmapped(pass.options.shadow_maps);
    const FileOnCard& file = on_card.files.at(lamp.file.get());
    int pixels = 0;
    for (std::size_t s = 0; s < lamp.slabs.size(); ++s) {
        const SlabTextures& slab =
            file.sums.empty() ? file.sampled[s] : file.sums[s].levels.front();
        place_slab(slab, placement_of(lamp.slabs[s]));
        pixels += count_unmapped({device, surfaces, materials, slab, on_card.shadows[pass.lamp], s},
                                 passes.unmapped);
    }
    return pixels;
}

}  // namespace nearfield::render::gpu
