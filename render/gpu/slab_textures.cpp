// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/slab_textures.h"

#include "formats/files/error.h"
#include "formats/model/profile.h"
#include "render/gpu/storage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace nearfield::render::gpu {
namespace {

constexpr std::size_t kMostCells = 32;  // of slab.glsl

// As std140 lays SlabBlock out; where the slab stands comes first.
struct Placed {
    glm::dmat4 slab_from_world;
    glm::mat4 world_from_slab, turn;
};
struct SlabBlock {
    Placed placed;
    glm::vec4 s_min_texel_m, pitch_delta_m;
    glm::ivec4 grid_texels, cells_channels;
    std::array<glm::vec4, kMostCells> profile;
};
static_assert(sizeof(SlabBlock) == 128 + 2 * 64 + 4 * 16 + kMostCells * 16);

Placed placed_by(const SlabPlacement& placement) {
    return {placement.slab_from_world, glm::mat4(placement.world_from_slab),
            glm::mat4(glm::mat3(placement.slab_from_world_rotation))};
}

SlabBlock block_of(const Slab& slab,
                   const SlabPlacement& placement,
                   int channels,
                   bool has_chroma) {
    SlabBlock block{};
    block.placed = placed_by(placement);
    block.s_min_texel_m = glm::vec4(slab.s_min_m, slab.texel_m());
    const bool is_radiance = slab.weighting == Weighting::Radiance;
    block.pitch_delta_m = glm::vec4(slab.pitch_m, slab.delta_m, is_radiance ? 1.0 : 0.0);
    block.grid_texels = glm::ivec4(slab.grid, slab.texels);
    block.cells_channels = {static_cast<int>(slab.profile.cells.size()), channels,
                            has_chroma ? 1 : 0, slab.image_count()};
    for (std::size_t c = 0; c < slab.profile.cells.size(); ++c) {
        const auto& [a0, a1, a2] = slab.profile.cells[c];
        block.profile[c] = glm::vec4(a0, a1, a2, model::integral(slab.profile, c));
    }
    return block;
}

std::vector<float> edges_of(const Slab& slab) {
    const auto cells = static_cast<int>(slab.profile.cells.size());
    std::vector<float> edges;
    for (const int axis : {0, 1}) {
        const double first_m = slab.basis_center_m(0, 0)[axis] - 0.5 * cells * slab.pitch_m[axis];
        for (int k = 0; k < slab.grid[axis] + cells; ++k)
            edges.push_back(static_cast<float>(first_m + k * slab.pitch_m[axis]));
    }
    for (const int axis : {0, 1})
        for (int k = 0; k < slab.grid[axis]; ++k)
            edges.push_back(static_cast<float>(slab.basis_center_m(k, k)[axis]));
    return edges;
}

// C_m's luminance, [image][j][i].
std::vector<float> luminance_of(const Slab& slab) {
    const std::size_t count = slab.texel_count() * static_cast<std::size_t>(slab.image_count());
    const float *r = slab.coeffs.data(), *g = r + count, *b = g + count;
    std::vector<float> y(count);
    for (std::size_t k = 0; k < count; ++k)
        y[k] = static_cast<float>(kLuminanceRgb[0]) * r[k] +
               static_cast<float>(kLuminanceRgb[1]) * g[k] +
               static_cast<float>(kLuminanceRgb[2]) * b[k];
    return y;
}

// Red and blue over luminance, interleaved.
std::vector<float> chroma_of(const Slab& slab, const std::vector<float>& luminance) {
    const std::size_t count = luminance.size();
    const float *r = slab.coeffs.data(), *b = r + 2 * count;
    std::vector<float> chroma(2 * count, 0.0F);
    for (std::size_t k = 0; k < count; ++k)
        if (luminance[k] > 0.0F) {
            chroma[2 * k] = r[k] / luminance[k];
            chroma[2 * k + 1] = b[k] / luminance[k];
        }
    return chroma;
}

Texture make_images(Device& device,
                    const char* what,
                    GLenum format,
                    glm::ivec2 size,
                    int layers,
                    int channels,
                    const std::vector<float>& values) {
    Texture texture = make_texture_array(device, what, format, size, layers);
    upload_layers(texture, size, 0, layers, channels, values.data());
    device.check(what);
    return texture;
}

void upload_tables(Device& device,
                   const Slab& slab,
                   const SlabTables& tables,
                   const std::vector<float>& luminance,
                   bool has_chroma,
                   SlabTextures& textures) {
    const int images = slab.image_count();
    textures.luminance = make_images(device, "luminance of a lamp's images", GL_R32F, slab.texels,
                                     images, 1, luminance);
    if (has_chroma)
        textures.chroma = make_images(device, "chroma of a lamp's images", GL_RG16F, slab.texels,
                                      images, 2, chroma_of(slab, luminance));
    std::vector<float> area(2 * tables.sat_hi.size());
    for (std::size_t k = 0; k < tables.sat_hi.size(); ++k) {
        area[2 * k] = tables.sat_hi[k];
        area[2 * k + 1] = tables.sat_lo[k];
    }
    textures.area =
        make_images(device, "summed-area tables", GL_RG32F, slab.texels + 1, images, 2, area);
    textures.totals = make_buffer_of(device, tables.total);
}

void upload_cdfs(Device& device,
                 const Slab& slab,
                 const SlabTables& tables,
                 SlabTextures& textures) {
    const int images = slab.image_count();
    const glm::ivec2 marginal(slab.texels.x + 1, images);
    textures.marginal = make_texture(device, "marginal CDFs", GL_R32F, marginal);
    upload(textures.marginal, marginal, 1, tables.marginal_cdf.data());
    textures.conditional =
        make_images(device, "conditional CDFs", GL_R32F, {slab.texels.y + 1, slab.texels.x}, images,
                    1, tables.conditional_cdf);
}

}  // namespace

SlabTextures upload_slab(Device& device,
                         const Slab& slab,
                         const std::vector<glm::ivec4>& lit,
                         const SlabTables* tables,
                         const SlabNeeds& needs,
                         const SlabPlacement& placement) {
    if (slab.profile.cells.size() > kMostCells)
        throw Error{"a basis with too many cells for the OpenGL renderer", slab.profile.name,
                    fmt::format("at most {}", kMostCells),
                    fmt::format("{}", slab.profile.cells.size())};
    SlabTextures textures;
    const bool has_chroma = needs.has_color && slab.channels == 3;
    textures.channels = has_chroma ? 3 : 1;
    const int images = slab.image_count();
    std::vector<float> reduced;  // to luminance
    if (slab.channels == 3 && (needs.tables || !has_chroma))
        reduced = luminance_of(slab);
    const std::vector<float>& luminance = slab.channels == 3 ? reduced : slab.coeffs;
    if (needs.coeffs)
        textures.coeffs =
            make_images(device, "a lamp's images", GL_R32F, slab.texels, textures.channels * images,
                        1, has_chroma ? slab.coeffs : luminance);
    if (needs.tables)
        upload_tables(device, slab, *tables, luminance, has_chroma, textures);
    if (needs.cdfs)
        upload_cdfs(device, slab, *tables, textures);
    const SlabBlock block = block_of(slab, placement, textures.channels, has_chroma);
    textures.block = make_buffer(device, std::as_bytes(std::span(&block, 1)));
    textures.edges = make_buffer_of(device, edges_of(slab));
    textures.lit = make_buffer_of(device, lit);
    return textures;
}

void place_slab(const SlabTextures& slab, const SlabPlacement& placement) {
    const Placed placed = placed_by(placement);
    glNamedBufferSubData(slab.block.id(), 0, sizeof(placed), &placed);
}

void bind_slab(const SlabTextures& slab) {
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, slab.block.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, slab.edges.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, slab.lit.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, slab.totals.id());
    const std::array<GLuint, 3> images = {slab.coeffs.id(), slab.luminance.id(), slab.chroma.id()};
    glBindTextures(8, static_cast<GLsizei>(images.size()), images.data());
    const std::array<GLuint, 2> cdfs = {slab.marginal.id(), slab.conditional.id()};
    glBindTextures(12, static_cast<GLsizei>(cdfs.size()), cdfs.data());
    constexpr GLuint kAreaImage = 7;
    glBindImageTexture(kAreaImage, slab.area.id(), 0, GL_TRUE, 0, GL_READ_ONLY, GL_RG32F);
}

}  // namespace nearfield::render::gpu
