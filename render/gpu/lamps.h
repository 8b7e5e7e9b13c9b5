// SPDX-License-Identifier: Apache-2.0
/// A scene's lamps on the graphics card. A file is there once, however many lamps name it.
#pragma once

#include "render/gpu/light_samples.h"
#include "render/gpu/light_sum.h"
#include "render/gpu/shadow_maps.h"
#include "render/lamps.h"
#include "render/options.h"
#include "render/plan.h"

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

namespace nearfield::render::gpu {

/// A light field's slabs, as the passes read them; what no pass reads is not there.
struct FileOnCard {
    std::shared_ptr<const LoadedLightField> file;  // whose address another must not get
    std::vector<SumSlab> sums;
    std::vector<SlabTextures> sampled;
    std::uint64_t sum_bytes = 0, table_bytes = 0;
};

struct LampsOnCard {
    std::map<const LoadedLightField*, FileOnCard> files;
    std::vector<ShadowMaps> shadows;  // [lamp]
    std::uint64_t sum_bytes = 0, table_bytes = 0;
    bool has_color = false, has_cdfs = false;  // what files hold
};

/// Uploads what the plan's passes read and is not there; what is there of other files is dropped.
void upload_lamps(Device& device,
                  const Lamps& lamps,
                  const Plan& plan,
                  const RenderOptions& options,
                  LampsOnCard& on_card);

/// Programs that light surfaces, in the variants that the plan calls for.
struct LightPasses {
    LightSumPrograms sums, unshadowed_sums;
    LightSamples samples, unshadowed_samples;
    Program unmapped;  // count_unmapped's, once it was asked for
};

/// A lamp whose light is added at the surfaces that are bound, to image units 0 and 1.
struct LampPass {
    const Lamps& lamps;
    std::size_t lamp = 0;
    const Plan& plan;
    const RenderOptions& options;
    SampleQuery query;  // dim is the lamp's
};

LightPasses make_light_passes(Device& device,
                              const Plan& plan,
                              const RenderOptions& options,
                              bool has_tangents);

/// Its windowed sums, if there are any. q: as RenderOptions::q.
void add_sums(
    Device& device, LightPasses& passes, LampsOnCard& on_card, const LampPass& pass, int q);
/// Its samples, if any are drawn: of all its light, or beside sums of gloss alone.
void add_samples(Device& device, LightPasses& passes, LampsOnCard& on_card, const LampPass& pass);

/// Pixels between the planes of a lamp with shadows that some of its maps do not show
/// (shadow_maps.h), slab by slab; 0 for one without. Changes what is bound.
int count_unmapped(Device& device,
                   const Surfaces& surfaces,
                   const Buffer& materials,
                   const LampsOnCard& on_card,
                   const LampPass& pass,
                   LightPasses& passes);

}  // namespace nearfield::render::gpu
