// SPDX-License-Identifier: Apache-2.0
/// A lamp's light by samples, and by samples alone what its slabs send to glossy lobes:
/// render/shaders/samples*.
///
/// The same samples as render/cpu/shade_samples.cpp: same sets, same random numbers, same joint
/// restricted densities (formats/shared). Unshadowed, pixels differ from the CPU's by rounding,
/// which now and then moves a sample to the next texel or image: tests/render/gpu/samples_*.
#pragma once

#include "formats/model/sampler.h"
#include "render/gpu/device.h"
#include "render/gpu/objects.h"
#include "render/gpu/shader.h"
#include "render/gpu/slab_textures.h"
#include "render/sample_sets.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <span>

namespace nearfield::render::gpu {

/// What the programs are compiled for.
struct SampleNeeds {
    model::Sampler sampler = model::Sampler::Systematic;
    model::Sequence sequence = model::Sequence::R2;
    model::Shift shift = model::Shift::Random;
    bool has_color = true;      // slabs have chroma
    bool has_shadows = true;    // visibility of U's cells is bound before each slab
    bool has_gloss = true;      // some material has a lobe
    bool gloss_only = false;    // the lobes' light alone: the diffuse part is the windowed sum's
    bool has_tangents = false;  // as Surfaces
    Defines more_defines = {};  // of shadows.glsl
};

/// Programs and what they keep from lamp to lamp.
struct LightSamples {
    SampleNeeds needs;
    Program weigh, draw;
    Texture blue_noise;  // only for Shift::BlueNoise
    Buffer energies, running_totals, set_luminances;
    std::uint64_t entries = 0, totals = 0, luminances = 0;  // that they hold
    std::uint64_t most_energies = std::uint64_t{1} << 24;   // of a band: 64 MiB
};

LightSamples make_light_samples(Device& device, const SampleNeeds& needs);

/// A slab as it is sampled, uploaded with tables (Precomputed and Pdis: with cdfs too).
struct SampledSlab {
    const SlabTextures* textures = nullptr;
    const Slab* slab = nullptr;
    /// Binds what shadows.glsl reads of this slab's cells; empty without shadows.
    std::function<void()> bind_shadows;
};

/// One lamp's samples in one pass. random numbers: of pixel, first_set + set and seed.
struct SampleQuery {
    glm::ivec2 size_px{0};
    SampleSets sets;
    std::uint32_t first_set = 0, seed = 1;
    int k_max = 0;  // Pdis: SamplerOptions::k_max
    float dim = 1.0F;
};

/// Adds the lamp's light to image units 0 and 1 (radiance and its luminance's variance;
/// irradiance, but with gloss_only), which the caller has bound, with surface.glsl's bindings.
/// Passes "box energies" and "samples". Energies of a band of rows are kept, 8 rows at least.
void add_light_samples(Device& device,
                       LightSamples& samples,
                       std::span<const SampledSlab> slabs,
                       const SampleQuery& query);

}  // namespace nearfield::render::gpu
