// SPDX-License-Identifier: Apache-2.0
/// How a slab's arrays lie in an EXR file's parts: the one description that both writers and
/// readers use.
#pragma once

#include "formats/files/exr_file.h"
#include "formats/files/luminaire.h"
#include "formats/files/metadata.h"

#include <string>
#include <type_traits>
#include <vector>

namespace nearfield {

inline std::string replicate_table(std::size_t replicate) {
    return "replicate" + std::to_string(replicate);
}

/// "slab0.coeffs": what a part of a slab is called.
inline std::string part_name(std::size_t slab, const std::string& table) {
    return "slab" + std::to_string(slab) + "." + table;
}

/// An array [channel][m][j][i] as an atlas of upright images.
template <typename Value>
exr::Atlas<Value> image_atlas(std::string part, const Slab& slab, glm::ivec2 image, Value* data) {
    exr::Atlas<Value> atlas{std::move(part), slab.grid, image, {}, exr::Values::NonNegative, true};
    const std::ptrdiff_t channel_stride =
        std::ptrdiff_t{image.x} * image.y * slab.grid.x * slab.grid.y;
    for (int channel = 0; channel < slab.channels; ++channel) {
        const std::string name = slab.channels == 1 ? "Y" : std::string(1, "RGB"[channel]);
        atlas.planes.push_back(exr::upright(name, data, image));
        atlas.planes.back().first += channel * channel_stride;
    }
    return atlas;
}

/// The parts of a slab's tables. Tables is SlabTables (to read into) or const SlabTables.
template <typename Tables>
auto table_atlases(std::size_t slab_index, const Slab& slab, Tables& tables) {
    using Value = std::conditional_t<std::is_const_v<Tables>, const float, float>;
    using exr::Atlas, exr::Plane, exr::Values, exr::upright;
    const auto name = [&](const char* table) { return part_name(slab_index, table); };
    // The components of an array of vec2, interleaved; empty arrays have no address.
    const auto components = [](auto& pairs) -> Value* {
        return pairs.empty() ? nullptr : &pairs.front().x;
    };
    const auto interleaved = [](const char* channel, Value* data, std::ptrdiff_t component,
                                glm::ivec2 size) {
        const std::ptrdiff_t row = std::ptrdiff_t{2} * size.x;
        return Plane<Value>{channel, data, (size.y - 1) * row + component, 0, 2, -row};
    };
    const glm::ivec2 texels = slab.texels;
    const std::ptrdiff_t h = texels.y;
    std::vector<Atlas<Value>> parts;

    Value* median = components(tables.median_s_m);
    parts.push_back({name("images"),
                     {1, 1},
                     slab.grid,
                     {upright("total", tables.total.data(), slab.grid),
                      interleaved("median_x_m", median, 0, slab.grid),
                      interleaved("median_y_m", median, 1, slab.grid)},
                     Values::Finite,
                     true});
    parts.push_back({name("sat"),
                     slab.grid,
                     texels + 1,
                     {upright("hi", tables.sat_hi.data(), texels + 1),
                      upright("lo", tables.sat_lo.data(), texels + 1)},
                     Values::Finite,
                     true});
    parts.push_back({name("marginal_cdf"),
                     slab.grid,
                     {texels.x + 1, 1},
                     {upright("Y", tables.marginal_cdf.data(), {texels.x + 1, 1})},
                     Values::Finite,
                     true});
    // Stored in memory column by column, in the file as an image like the others.
    parts.push_back(
        {name("conditional_cdf"),
         slab.grid,
         {texels.x, texels.y + 1},
         {Plane<Value>{"Y", tables.conditional_cdf.data(), h, texels.x * (h + 1), h + 1, -1}},
         Values::Finite,
         true});
    for (std::size_t level = 0; level < tables.mips.size(); ++level) {
        auto& mip = tables.mips[level];
        parts.push_back(image_atlas<Value>(name("mip") + std::to_string(level + 1), slab,
                                           mip.texels, mip.coeffs.data()));
    }
    Value* reference = components(tables.cell_reference_s_m);
    parts.push_back({name("cells"),
                     {1, 1},
                     tables.cells,
                     {upright("total", tables.cell_total.data(), tables.cells),
                      interleaved("reference_x_m", reference, 0, tables.cells),
                      interleaved("reference_y_m", reference, 1, tables.cells)},
                     Values::Finite,
                     true});
    return parts;
}

/// The parts of a light field, to write.
std::vector<exr::Atlas<const float>> lightfield_atlases(const LightField& lightfield);

/// Reads a light field, everything checked against the file's size before anything is allocated.
/// `accepted`: what coefficients and sigma may be.
Description read_lightfield_parts(exr::Reader& reader,
                                  const std::string& path,
                                  exr::Values accepted = exr::Values::NonNegative);

}  // namespace nearfield
