// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/sky_light.h"

#include "formats/files/error.h"
#include "render/gpu/storage.h"
#include "render/sample_sets.h"

#include <fmt/format.h>

#include <vector>

namespace nearfield::render::gpu {
namespace {

// Bindings of sky.glsl, sky_samples.comp and sky_visibility.comp.
constexpr GLuint kHidden = 7, kShift = 6, kHiddenImage = 2, kFound = 9;
constexpr GLint kRadius = 0;

SkyVariant variant_of(const Plan& plan, const RenderOptions& options, bool has_tangents) {
    SkyVariant variant;
    const bool is_lights = options.environment.method == EnvironmentMethod::Lights;
    variant.has_irradiance = has_pass(plan, PassId::EnvironmentIrradiance);
    variant.has_lights = is_lights;
    variant.has_samples = !is_lights && has_pass(plan, PassId::EnvironmentSamples);
    variant.has_shadows = hides_sky(plan);
    variant.has_tangents = has_tangents;
    variant.is_anisotropic = options.environment.is_anisotropic;
    variant.is_shifted = options.environment.is_shifted && variant.has_samples;
    variant.level = options.environment.level;
    variant.is_smoothed = options.environment.filter_px > 0;
    variant.has_counts = options.environment.error_rel > 0.0;
    variant.has_turns = counts_by_turns(plan, options);
    return variant;
}

Defines defines_of(const SkyVariant& variant) {
    Defines defines = {fmt::format("LEVEL {}u", word_of(variant.level))};
    if (variant.has_shadows)
        defines.emplace_back("HAS_SHADOWS");
    if (variant.has_tangents)
        defines.emplace_back("HAS_TANGENTS");
    if (variant.is_anisotropic)
        defines.emplace_back("IS_ANISOTROPIC");
    if (variant.is_shifted)
        defines.emplace_back("HAS_SHIFT");
    if (variant.has_counts)
        defines.emplace_back("HAS_COUNTS");
    if (variant.has_turns)
        defines.emplace_back("HAS_TURNS");
    return defines;
}

SkyPasses make_passes(Device& device, const SkyVariant& variant, glm::ivec2 size_px) {
    const std::uint64_t before = device.allocated_bytes();
    const Defines defines = defines_of(variant);
    SkyPasses passes;
    passes.variant = variant;
    passes.size_px = size_px;
    passes.past = link_compute("render/shaders/sky_past.comp", {});
    if (variant.has_irradiance)
        passes.irradiance = link_compute("render/shaders/sky_irradiance.comp", defines);
    if (variant.has_samples)
        passes.samples = link_compute("render/shaders/sky_samples.comp", defines);
    if (variant.has_lights)
        passes.lights = link_compute("render/shaders/sky_lights.comp", defines);
    if (variant.has_shadows && !variant.has_lights) {
        // Without the shadows that it is to find.
        passes.visibility = link_compute("render/shaders/sky_visibility.comp", {});
        passes.hidden =
            make_texture_array(device, "what of the environment is hidden", GL_RGBA32F, size_px, 4);
        if (variant.is_smoothed) {
            passes.smoothing = link_compute("render/shaders/sky_smoothing.comp", {});
            passes.found = make_texture_array(device, "what is hidden, before it is smoothed",
                                              GL_RGBA32F, size_px, 4);
        }
    }
    if (variant.is_shifted)
        passes.shift = make_texture(device, "shifts of samples", GL_RG32F, size_px);
    passes.bytes = device.allocated_bytes() - before;
    return passes;
}

void upload_shifts(const RenderOptions& options,
                   std::uint32_t camera_sample,
                   const SkyPasses& passes) {
    std::vector<glm::vec2> shifts;
    const auto size = glm::uvec2(passes.size_px);
    for (glm::uint y = 0; y < size.y; ++y)
        for (glm::uint x = 0; x < size.x; ++x)
            shifts.push_back(shift_of_set(options.shift, {x, y},
                                          camera_sample * static_cast<std::uint32_t>(kMostSets),
                                          options.seed ^ kFilteredSeed));
    upload(passes.shift, passes.size_px, 2, &shifts.front()[0]);
}

/// One pass over the surfaces, with all that it may read.
void run(Device& device, const char* name, const Program& program, const SkyKept& kept) {
    device.run_pass(name, [&] {
        bind_sky(kept.on_card);
        if (kept.passes.variant.has_shadows)
            bind_sky_maps(kept.maps);
        glBindTextureUnit(kHidden, kept.passes.hidden.id());
        glBindTextureUnit(kShift, kept.passes.shift.id());
        dispatch_2d(program, kept.passes.size_px.x, kept.passes.size_px.y);
    });
}

}  // namespace

void prepare_sky(Device& device,
                 const Sky& sky,
                 const Plan& plan,
                 const RenderOptions& options,
                 const SceneBuffers& scene,
                 glm::ivec2 size_px,
                 SkyKept& kept) {
    if (plan.draws_sky)
        throw Error{"cannot render by OpenGL", "environment",
                    "--environment filtered or lights: rays are the CPU's",
                    name_of(options.environment.method)};
    device.run_pass("environment", [&] { upload_sky(device, sky, options, kept.on_card); });
    const SkyVariant variant = variant_of(plan, options, scene.has_tangents);
    if (!kept.passes.past || !(kept.passes.variant == variant) || kept.passes.size_px != size_px)
        kept.passes = make_passes(device, variant, size_px);
    if (!variant.has_shadows)
        return;
    if (!kept.map_pass.draw)
        kept.map_pass = make_sky_map_pass();
    device.run_pass("sky maps", [&] {
        update_sky_maps(device, kept.map_pass, scene, sky, options.environment.map_px, kept.maps);
    });
}

void add_sky_light(Device& device,
                   const RenderOptions& options,
                   std::uint32_t camera_sample,
                   const SkyKept& kept) {
    const SkyPasses& passes = kept.passes;
    run(device, "environment", passes.past, kept);
    if (passes.visibility) {
        const auto write_to = [](const Texture& texture) {
            glBindImageTexture(kHiddenImage, texture.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY,
                               GL_RGBA32F);
        };
        write_to(passes.smoothing ? passes.found : passes.hidden);
        run(device, "sky maps", passes.visibility, kept);
        if (passes.smoothing) {
            write_to(passes.hidden);
            glProgramUniform1i(passes.smoothing.id(), kRadius, options.environment.filter_px);
            glBindTextureUnit(kFound, passes.found.id());
            run(device, "sky maps", passes.smoothing, kept);
        }
    }
    if (passes.irradiance)
        run(device, "sky irradiance", passes.irradiance, kept);
    if (passes.variant.is_shifted)
        upload_shifts(options, camera_sample, passes);
    if (passes.samples)
        run(device, "sky samples", passes.samples, kept);
    if (passes.lights)
        run(device, "sky samples", passes.lights, kept);
}

}  // namespace nearfield::render::gpu
