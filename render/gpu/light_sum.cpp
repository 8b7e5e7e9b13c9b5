// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/light_sum.h"

#include "formats/files/error.h"
#include "render/gpu/storage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace nearfield::render::gpu {
namespace {

// Locations in sum.comp.
constexpr GLint kDim = 0, kMip = 1, kFinestTexels = 2, kIsFirst = 3, kFirstRow = 4;
constexpr GLuint kLeftBinding = 7, kQuadsUnit = 20, kTablesUnit = 21;
constexpr std::size_t kWays = 2;  // by moments, by pieces

SumSlab without_levels(const Slab& slab) {
    SumSlab sum;
    sum.has_radiance_weighting = slab.weighting == Weighting::Radiance;
    sum.texels = slab.texels;
    const auto cells = static_cast<int>(slab.profile.cells.size());
    sum.cells = cells;
    sum.window_texels_x = static_cast<float>(cells * slab.pitch_m.x / slab.texel_m().x);
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

// Quads that a fetch may reach behind the last row (kQuads of sum_cell.glsl, and more).
constexpr std::size_t kSpareQuads = 64;

void check_quads(const Device& device, std::size_t quads) {
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    if (quads > static_cast<std::size_t>(most))
        throw Error{"too large for a buffer of " + device.renderer(), "a lamp's images",
                    fmt::format("at most {} times four texels", most), fmt::format("{}", quads)};
}

// Image by image, so that no second copy of all is made.
Buffer upload_images(Device& device, const Slab& slab, int channels) {
    const int images = slab.image_count();
    const auto width = static_cast<std::size_t>(slab.texels.x);
    const std::size_t padded = (width + 3) / 4 * 4;
    const std::size_t image_floats = padded * static_cast<std::size_t>(slab.texels.y);
    const std::size_t floats =
        image_floats * static_cast<std::size_t>(channels * images) + 4 * kSpareQuads;
    check_quads(device, floats / 4);
    Buffer buffer = make_zero_buffer(device, floats * sizeof(float), "a lamp's images");
    std::vector<float> image(image_floats, 0.0F);
    for (int c = 0; c < channels; ++c)
        for (int m = 0; m < images; ++m) {
            for (int j = 0; j < slab.texels.y; ++j) {
                float* row = image.data() + static_cast<std::size_t>(j) * padded;
                if (channels == slab.channels)
                    std::copy_n(slab.coeffs.data() + slab.image_offset(c, m) +
                                    static_cast<std::size_t>(j) * width,
                                width, row);
                else
                    std::ranges::copy(luminance_row(slab, m, j), row);
            }
            const std::size_t bytes = image_floats * sizeof(float);
            glNamedBufferSubData(
                buffer.id(),
                static_cast<GLintptr>(static_cast<std::size_t>(c * images + m) * bytes),
                static_cast<GLsizeiptr>(bytes), image.data());
        }
    device.check("a lamp's images");
    return buffer;
}

Texture view_quads(Device& device, const Buffer& images) {
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &id);
    Texture view(id);
    glTextureBuffer(id, GL_RGBA32F, images.id());
    device.check("a lamp's images");
    return view;
}

// sum_tables of sum_view.glsl.
Texture upload_tables(Device& device, const model::PreparedSlab& level) {
    const Slab& slab = level.slab;
    const int images = slab.image_count(), cells = static_cast<int>(slab.profile.cells.size());
    const int width = std::max(images, std::max(slab.grid.x, slab.grid.y) + cells - 1);
    const glm::ivec2 size(width, 3);
    std::vector<glm::vec4> texels(static_cast<std::size_t>(width) * 3, glm::vec4(0.0F));
    std::copy(level.lit.begin(), level.lit.end(), texels.begin());
    for (const int axis : {0, 1}) {
        const double pitch_m = slab.pitch_m[axis], center_m = slab.basis_center_m(0, 0)[axis];
        for (int k = 0; k < slab.grid[axis] + cells - 1; ++k)
            texels[static_cast<std::size_t>((1 + axis) * width + k)] =
                glm::dvec4(center_m + (k - 0.5 * cells) * pitch_m,
                           center_m + (k + 1 - 0.5 * cells) * pitch_m, center_m + k * pitch_m, 0.0);
    }
    Texture texture = make_texture(device, "a lamp's cells", GL_RGBA32F, size);
    upload(texture, size, 4, &texels.front().x);
    return texture;
}

void upload_level(Device& device,
                  const model::PreparedSlab& level,
                  bool has_color,
                  const SlabPlacement& placement,
                  SumSlab& sum) {
    SlabNeeds needs;
    needs.has_color = has_color;
    sum.levels.push_back(upload_slab(device, level.slab, level.lit, nullptr, needs, placement));
    sum.images.push_back(upload_images(device, level.slab, sum.levels.back().channels));
    sum.quads.push_back(view_quads(device, sum.images.back()));
    sum.tables.push_back(upload_tables(device, level));
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
        defines.push_back(fmt::format("CELLS {}", variant.cells));
    }
    if (programs.shadows == SumShadows::Pdis)
        defines.emplace_back("SHADOW_PDIS");
    defines.push_back(fmt::format("QUADS {}", variant.quads));
    LightSumPrograms::Pair pair;
    pair.by_moments = link_compute("render/shaders/sum.comp", defines);
    defines.emplace_back("BY_PIECES");
    pair.by_pieces = link_compute("render/shaders/sum.comp", defines);
    return pair;
}

// Quads that hold any window's columns, wherever in a quad it starts; no more than are worth their
// registers. With shadows each cell of the basis function has its own.
int quads_of(const SumSlab& slab, int q, bool has_shadows) {
    constexpr int kMostQuads = 8, kMostOfAllCells = 32;
    const float widest =
        q == 0 ? slab.window_texels_x : std::min(slab.window_texels_x, static_cast<float>(q));
    const float columns = std::ceil(std::min(widest, 4.0F * kMostQuads)) + 1.0F;
    const int most =
        has_shadows ? std::clamp(kMostOfAllCells / slab.cells, 1, kMostQuads) : kMostQuads;
    return std::min(static_cast<int>(columns + 6.0F) / 4, most);
}

const LightSumPrograms::Pair& programs_for(LightSumPrograms& programs, const SumSlab& slab, int q) {
    const bool has_shadows = programs.shadows != SumShadows::None;
    LightSumPrograms::Variant variant{};
    variant.has_color = slab.levels.front().channels == 3;
    variant.has_radiance_weighting = slab.has_radiance_weighting;
    variant.quads = quads_of(slab, q, has_shadows);
    if (has_shadows) {
        variant.cells = slab.cells;
        variant.ring_cells = slab.ring_cells;
    }
    const auto found = programs.linked.find(variant);
    if (found != programs.linked.end())
        return found->second;
    return programs.linked.emplace(variant, link(programs, variant)).first->second;
}

bool read_left(const Buffer& left, std::size_t way) {
    return read_buffer<std::uint32_t>(left, kWays)[way] != 0;
}

struct Rows {
    int first = 0, count = 0, width = 0;
};

// Whether pixels are left that this program is to go on with.
bool dispatch(const Program& program, std::size_t way, const Buffer& left, const Rows& rows) {
    const std::uint32_t zero = 0;
    glProgramUniform1i(program.id(), kFirstRow, rows.first);
    glNamedBufferSubData(left.id(), static_cast<GLintptr>(way * sizeof zero), sizeof zero, &zero);
    dispatch_2d(program, rows.width, rows.count);
    return read_left(left, way);
}

// All pixels of some rows, of one level.
void sum_rows(Device& device,
              const LightSumPrograms::Pair& pair,
              const Buffer& left,
              const Rows& rows) {
    const auto dispatch_or_stop = [&](const Program& program, std::size_t way) {
        device.continue_or_stop();
        return dispatch(program, way, left, rows);
    };
    const std::uint32_t zero = 0;
    glNamedBufferSubData(left.id(), sizeof zero, sizeof zero, &zero);
    glProgramUniform1i(pair.by_moments.id(), kIsFirst, 1);
    bool is_left = dispatch_or_stop(pair.by_moments, 0);
    glProgramUniform1i(pair.by_moments.id(), kIsFirst, 0);
    while (is_left)
        is_left = dispatch_or_stop(pair.by_moments, 0);
    is_left = read_left(left, 1);
    while (is_left)
        is_left = dispatch_or_stop(pair.by_pieces, 1);
}

// A picture that may be given up is drawn in pieces, small enough for a rasterizer on the CPU to
// come back soon: pixels do not know of each other.
int rows_at_once(const Device& device, glm::ivec2 size_px) {
    constexpr int kPixelsOnCpu = 1 << 12, kPixelsOnCard = 1 << 18;
    if (!device.can_be_stopped())
        return size_px.y;
    const int pixels = device.is_on_cpu() ? kPixelsOnCpu : kPixelsOnCard;
    return std::min(std::max(pixels / size_px.x / 8 * 8, 8), size_px.y);  // whole groups
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
    const LightSumPrograms::Pair& pair = programs_for(programs, slab, q);
    if (!programs.left)
        programs.left = make_zero_buffer(device, kWays * sizeof(std::uint32_t));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kLeftBinding, programs.left.id());
    const int coarsest = q == 0 ? 0 : static_cast<int>(slab.levels.size()) - 1;
    for (int level = 0; level <= coarsest; ++level) {
        bind_slab(slab.levels[static_cast<std::size_t>(level)]);
        glBindTextureUnit(kQuadsUnit, slab.quads[static_cast<std::size_t>(level)].id());
        glBindTextureUnit(kTablesUnit, slab.tables[static_cast<std::size_t>(level)].id());
        for (const Program* program : {&pair.by_moments, &pair.by_pieces}) {
            glProgramUniform1f(program->id(), kDim, dim);
            glProgramUniform3i(program->id(), kMip, level, coarsest, q);
            glProgramUniform2i(program->id(), kFinestTexels, slab.texels.x, slab.texels.y);
        }
        const int rows = rows_at_once(device, size_px);
        for (int row = 0; row < size_px.y; row += rows)
            sum_rows(device, pair, programs.left,
                     {row, std::min(rows, size_px.y - row), size_px.x});
    }
}

}  // namespace nearfield::render::gpu
