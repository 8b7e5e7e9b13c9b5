// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/light_samples.h"

#include "formats/model/sampler_draws.h"
#include "render/gpu/shader.h"
#include "render/gpu/storage.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::render::gpu {
namespace {

// Bindings and locations of samples_view.glsl and samples.comp.
constexpr GLuint kEnergies = 5, kRunningTotals = 6, kSetLuminances = 7, kBlueNoise = 14;
constexpr GLint kDim = 0, kBand = 1, kPart = 2, kDrawing = 3, kRandom = 4;

Defines defines_of(const SampleNeeds& needs) {
    Defines defines = {fmt::format("SAMPLER {}", static_cast<int>(needs.sampler)),
                       fmt::format("SEQUENCE {}", model::word_of(needs.sequence)),
                       fmt::format("SHIFT {}", model::word_of(needs.shift))};
    if (needs.has_color)
        defines.emplace_back("HAS_COLOR");
    if (needs.has_shadows)
        defines.emplace_back("HAS_SHADOWS");
    if (needs.has_gloss || needs.gloss_only)
        defines.emplace_back("HAS_GLOSS");
    if (needs.gloss_only)
        defines.emplace_back("GLOSS_ONLY");
    if (needs.has_tangents)
        defines.emplace_back("HAS_TANGENTS");
    defines.insert(defines.end(), needs.more_defines.begin(), needs.more_defines.end());
    return defines;
}

std::uint64_t entries_of(const Slab& slab, model::Sampler sampler) {
    const std::size_t cells = slab.profile.cells.size();
    return static_cast<std::uint64_t>(slab.image_count()) *
           (sampler == model::Sampler::Cells ? cells * cells : 1);
}

void reserve(Device& device,
             std::uint64_t count,
             std::size_t bytes_each,
             Buffer& buffer,
             std::uint64_t& held) {
    if (held >= count)
        return;
    buffer = make_zero_buffer(device, static_cast<std::size_t>(count) * bytes_each);
    held = count;
}

// A run of rows of the frame, and the lamp that is drawn there.
struct Band {
    int first_row, rows, width;
    GLint pixels;  // of the largest band
};

void set_part(const Program& program, const Band& band, const glm::ivec4& part) {
    glProgramUniform4i(program.id(), kBand, band.first_row, band.rows, band.width, band.pixels);
    glProgramUniform4i(program.id(), kPart, part.x, part.y, part.z, part.w);
}

void draw_band(Device& device,
               const LightSamples& samples,
               std::span<const SampledSlab> slabs,
               std::span<const glm::ivec4> parts,
               const Band& band) {
    device.run_pass("box energies", [&] {
        for (std::size_t k = 0; k < slabs.size(); ++k) {
            bind_slab(*slabs[k].textures);
            set_part(samples.weigh, band, parts[k]);
            dispatch_2d(samples.weigh, band.width, band.rows);
        }
    });
    device.run_pass("samples", [&] {
        for (std::size_t k = 0; k < slabs.size(); ++k) {
            bind_slab(*slabs[k].textures);
            if (slabs[k].bind_shadows)
                slabs[k].bind_shadows();
            set_part(samples.draw, band, parts[k]);
            dispatch_2d(samples.draw, band.width, band.rows);
        }
    });
}

}  // namespace

LightSamples make_light_samples(Device& device, const SampleNeeds& needs) {
    LightSamples samples;
    samples.needs = needs;
    const Defines defines = defines_of(needs);
    samples.weigh = link_compute("render/shaders/samples_energy.comp", defines);
    samples.draw = link_compute("render/shaders/samples.comp", defines);
    if (needs.shift == model::Shift::BlueNoise) {
        const glm::ivec2 size(model::kBlueNoiseTile);
        samples.blue_noise = make_texture(device, "blue noise", GL_RG32F, size);
        upload(samples.blue_noise, size, 2, &model::blue_noise_tile()[0].x);
    }
    return samples;
}

void add_light_samples(Device& device,
                       LightSamples& samples,
                       std::span<const SampledSlab> slabs,
                       const SampleQuery& query) {
    std::uint64_t entries = 0;
    std::vector<glm::ivec4> parts;  // first entry, the lamp's entries, slab, slabs
    for (const SampledSlab& slab : slabs) {
        parts.emplace_back(static_cast<int>(entries), 0, static_cast<int>(parts.size()),
                           static_cast<int>(slabs.size()));
        entries += entries_of(*slab.slab, samples.needs.sampler);
    }
    for (glm::ivec4& part : parts)
        part.y = static_cast<int>(entries);
    const auto width = static_cast<std::uint64_t>(query.size_px.x);
    // Whole groups of 8 x 8 pixels.
    const std::uint64_t fitting =
        samples.most_energies / std::max<std::uint64_t>(entries * width, 1) / 8 * 8;
    const int rows = static_cast<int>(std::min<std::uint64_t>(
        std::max<std::uint64_t>(fitting, 8), static_cast<std::uint64_t>(query.size_px.y)));
    const std::uint64_t pixels = width * static_cast<std::uint64_t>(rows);
    reserve(device, entries * pixels, sizeof(float), samples.energies, samples.entries);
    reserve(device, (slabs.size() + 1) * pixels, sizeof(double), samples.running_totals,
            samples.totals);
    reserve(device, kMostSets * pixels, sizeof(float), samples.set_luminances, samples.luminances);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kEnergies, samples.energies.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kRunningTotals, samples.running_totals.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kSetLuminances, samples.set_luminances.id());
    glBindTextureUnit(kBlueNoise, samples.blue_noise.id());
    const GLuint draw = samples.draw.id();
    glProgramUniform1f(draw, kDim, query.dim);
    glProgramUniform4i(draw, kDrawing, query.sets.samples, query.sets.sets, query.k_max, 0);
    glProgramUniform2ui(draw, kRandom, query.first_set, query.seed);
    for (int row = 0; row < query.size_px.y; row += rows)
        draw_band(device, samples, slabs, parts,
                  {row, std::min(rows, query.size_px.y - row), query.size_px.x,
                   static_cast<GLint>(pixels)});
}

}  // namespace nearfield::render::gpu
