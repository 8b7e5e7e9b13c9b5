// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/light_sum.h"

#include "render/gpu/storage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace nearfield::render::gpu {
namespace {

// Locations in sum.comp.
constexpr GLint kDim = 0, kMip = 1, kFinestTexels = 2, kIsFirst = 3;
constexpr GLuint kLeftBinding = 7, kQuadsUnit = 20;
constexpr std::size_t kWays = 2;  // by moments, by pieces

SumSlab without_levels(const Slab& slab) {
    SumSlab sum;
    sum.has_radiance_weighting = slab.weighting == Weighting::Radiance;
    sum.texels = slab.texels;
    const auto cells = static_cast<int>(slab.profile.cells.size());
    sum.ring_cells = cells * (slab.grid.y + cells - 1);
    return sum;
}

std::vector<float> luminance_row(const Slab& slab, int image, int j) {
    const auto width = static_cast<std::size_t>(slab.texels.x);
    std::vector<float> row(width, 0.0F);
    for (int c = 0; c < slab.channels; ++c) {
        const float* values =
            slab.coeffs.data() + slab.image_offset(c, image) + static_cast<std::size_t>(j) * width;
        const auto weight = static_cast<float>(kLuminanceRgb[static_cast<std::size_t>(c)]);
        for (std::size_t i = 0; i < width; ++i)
            row[i] += weight * values[i];
    }
    return row;
}

// Layer by layer, so that no second copy of all images is made.
Texture upload_quads(Device& device, const Slab& slab, int channels) {
    const int images = slab.image_count();
    const glm::ivec2 size((slab.texels.x + 3) / 4, slab.texels.y);
    Texture quads =
        make_texture_array(device, "a lamp's images", GL_RGBA32F, size, channels * images);
    const auto width = static_cast<std::size_t>(slab.texels.x);
    const std::size_t padded = 4 * static_cast<std::size_t>(size.x);
    std::vector<float> layer(padded * static_cast<std::size_t>(size.y), 0.0F);
    for (int c = 0; c < channels; ++c)
        for (int m = 0; m < images; ++m) {
            for (int j = 0; j < slab.texels.y; ++j) {
                float* row = layer.data() + static_cast<std::size_t>(j) * padded;
                if (channels == slab.channels)
                    std::copy_n(slab.coeffs.data() + slab.image_offset(c, m) +
                                    static_cast<std::size_t>(j) * width,
                                width, row);
                else
                    std::ranges::copy(luminance_row(slab, m, j), row);
            }
            upload_layers(quads, size, c * images + m, 1, 4, layer.data());
        }
    device.check("a lamp's images");
    return quads;
}

void upload_level(Device& device,
                  const model::PreparedSlab& level,
                  bool has_color,
                  const SlabPlacement& placement,
                  SumSlab& sum) {
    SlabNeeds needs;
    needs.has_color = has_color;
    sum.levels.push_back(upload_slab(device, level.slab, level.lit, nullptr, needs, placement));
    sum.quads.push_back(upload_quads(device, level.slab, sum.levels.back().channels));
}

LightSumPrograms::Pair link(const LightSumPrograms& programs,
                            const LightSumPrograms::Variant& variant) {
    Defines defines = programs.more_defines;
    if (variant.has_color)
        defines.emplace_back("HAS_COLOR");
    if (variant.has_radiance_weighting)
        defines.emplace_back("IS_RADIANCE");
    if (programs.shadows != SumShadows::None) {
        defines.emplace_back("HAS_SHADOWS");
        defines.push_back(fmt::format("RING_CELLS {}", variant.ring_cells));
    }
    if (programs.shadows == SumShadows::Pdis)
        defines.emplace_back("SHADOW_PDIS");
    LightSumPrograms::Pair pair;
    pair.by_moments = link_compute("render/shaders/sum.comp", defines);
    defines.emplace_back("BY_PIECES");
    pair.by_pieces = link_compute("render/shaders/sum.comp", defines);
    return pair;
}

const LightSumPrograms::Pair& programs_for(LightSumPrograms& programs, const SumSlab& slab) {
    const bool has_shadows = programs.shadows != SumShadows::None;
    const LightSumPrograms::Variant variant{slab.levels.front().channels == 3,
                                            slab.has_radiance_weighting,
                                            has_shadows ? slab.ring_cells : 0};
    const auto found = programs.linked.find(variant);
    if (found != programs.linked.end())
        return found->second;
    return programs.linked.emplace(variant, link(programs, variant)).first->second;
}

bool read_left(const Buffer& left, std::size_t way) {
    return read_buffer<std::uint32_t>(left, kWays)[way] != 0;
}

// Whether pixels are left that this program is to go on with.
bool dispatch(const Program& program, std::size_t way, const Buffer& left, glm::ivec2 size_px) {
    const std::uint32_t zero = 0;
    glNamedBufferSubData(left.id(), static_cast<GLintptr>(way * sizeof zero), sizeof zero, &zero);
    dispatch_2d(program, size_px.x, size_px.y);
    return read_left(left, way);
}

}  // namespace

SumSlab upload_sum_slab(Device& device,
                        const model::PreparedSlab& prepared,
                        bool has_color,
                        const SlabPlacement& placement) {
    SumSlab sum = without_levels(prepared.slab);
    upload_level(device, prepared, has_color, placement, sum);
    return sum;
}

SumSlab upload_sum_slab(Device& device,
                        const model::PreparedMips& mips,
                        bool has_color,
                        const SlabPlacement& placement) {
    SumSlab sum = without_levels(mips.levels.front().slab);
    for (const model::PreparedSlab& level : mips.levels)
        upload_level(device, level, has_color, placement, sum);
    return sum;
}

void add_light_sum(Device& device,
                   LightSumPrograms& programs,
                   const SumSlab& slab,
                   int q,
                   float dim,
                   glm::ivec2 size_px) {
    const LightSumPrograms::Pair& pair = programs_for(programs, slab);
    if (!programs.left)
        programs.left = make_zero_buffer(device, kWays * sizeof(std::uint32_t));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kLeftBinding, programs.left.id());
    const int coarsest = q == 0 ? 0 : static_cast<int>(slab.levels.size()) - 1;
    for (int level = 0; level <= coarsest; ++level) {
        bind_slab(slab.levels[static_cast<std::size_t>(level)]);
        glBindTextureUnit(kQuadsUnit, slab.quads[static_cast<std::size_t>(level)].id());
        for (const Program* program : {&pair.by_moments, &pair.by_pieces}) {
            glProgramUniform1f(program->id(), kDim, dim);
            glProgramUniform3i(program->id(), kMip, level, coarsest, q);
            glProgramUniform2i(program->id(), kFinestTexels, slab.texels.x, slab.texels.y);
        }
        glProgramUniform1i(pair.by_moments.id(), kIsFirst, 1);
        bool is_left = dispatch(pair.by_moments, 0, programs.left, size_px);
        glProgramUniform1i(pair.by_moments.id(), kIsFirst, 0);
        while (is_left)
            is_left = dispatch(pair.by_moments, 0, programs.left, size_px);
        is_left = read_left(programs.left, 1);
        while (is_left)
            is_left = dispatch(pair.by_pieces, 1, programs.left, size_px);
    }
}

}  // namespace nearfield::render::gpu
