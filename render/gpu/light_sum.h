// SPDX-License-Identifier: Apache-2.0
/// The windowed sum on the graphics card: diffuse light of a lamp's slabs, exact in float and
/// without noise (model/prepared.h says of what).
///
/// Precision: relative error against the sum in double 1e-4 or less wherever the light is not a
/// thousandth of its surroundings', receivers whose plane cuts U included: all in float, but for
/// the distance of U from the receiver's plane. Cost: a fetch and 8 multiply-adds for four texels
/// of a window and channel, rows that meet two rows of U's cells twice; receivers whose plane cuts
/// U cost many times as much. What is long is done in several dispatches, after each of which 8
/// bytes are read back.
#pragma once

#include "formats/model/mip_sum.h"
#include "render/gpu/device.h"
#include "render/gpu/shader.h"
#include "render/gpu/slab_textures.h"

#include <glm/glm.hpp>

#include <map>
#include <utility>
#include <vector>

namespace nearfield::render::gpu {

/// How a cell's visibility (shadows.glsl) weighs on light.
enum class SumShadows {
    None,    // not at all: nothing is fetched
    Shares,  // each cell's own light by its own
    Pdis,    // an image's light by the plain mean over the cells of its basis function
};

/// A slab and its coarser levels, as the sum reads them.
struct SumSlab {
    std::vector<SlabTextures> levels;  // [0] exact; as PreparedMips::levels; without images
    /// [level]: the images, floats [channel][image][row][column], and their view, RGBA32F: a fetch
    /// brings four neighbors. Rows end in zeros.
    std::vector<Buffer> images;
    std::vector<Texture> quads;
    std::vector<Texture> tables;  // [level]: what sum_view.glsl says
    bool has_radiance_weighting = false;
    glm::ivec2 texels{0};          // of level 0
    int cells = 1;                 // n
    float window_texels_x = 0.0F;  // of level 0: no window of it is wider
    int ring_cells = 0;            // n (H + n - 1): cells whose visibility is kept at once
};

/// Uploads what the sum alone reads. Throws Error where a level passes the device's limits.
SumSlab upload_sum_slab(Device& device,
                        const model::PreparedSlab& prepared,
                        bool has_color,
                        const SlabPlacement& placement);
/// With all levels, for q > 0.
SumSlab upload_sum_slab(Device& device,
                        const model::PreparedMips& mips,
                        bool has_color,
                        const SlabPlacement& placement);

/// Compiled when a slab first needs them: color, weighting and shadows make the variants.
struct LightSumPrograms {
    SumShadows shadows = SumShadows::None;
    Defines more_defines;  // put before every variant
    struct Variant {
        bool has_color, has_radiance_weighting;
        int quads;              // of texels along x whose weights are kept
        int cells, ring_cells;  // 0 without shadows
        // NOLINTNEXTLINE(modernize-use-nullptr): it takes the comparison's 0 for a pointer.
        auto operator<=>(const Variant&) const = default;
    };
    struct Pair {
        Program by_moments, by_pieces;
    };
    std::map<Variant, Pair> linked;
    Buffer left;  // is_left of sum.comp: whether pixels need another dispatch
};

/// Adds one slab's light to lamp_light and lamp_irradiance (image units 0 and 1, whose alpha of
/// irradiance must be 0 and remains so). Surfaces, and what shadows.glsl reads, must be bound; the
/// slab is bound here. q: windows span so many texels at most; 0: exact. Throws Error where a
/// program does not compile.
///
/// With q > 0 every receiver is summed on its own level, by model::level_for: where a tile's
/// receivers agree about it, the same as on the CPU.
void add_light_sum(Device& device,
                   LightSumPrograms& programs,
                   const SumSlab& slab,
                   int q,
                   float dim,
                   glm::ivec2 size_px);

}  // namespace nearfield::render::gpu
