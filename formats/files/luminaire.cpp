// SPDX-License-Identifier: Apache-2.0
#include "formats/files/luminaire.h"

#include "formats/files/error.h"
#include "formats/files/large_array.h"
#include "formats/files/lightfield_parts.h"
#include "formats/files/metadata.h"

#include <fmt/format.h>

#include <cmath>

namespace nearfield {
namespace {

/// The tables' sizes; mips and cells are part of them, arrays are left empty.
SlabTables shape_tables(const Slab& slab) {
    SlabTables tables;
    for (glm::ivec2 size = slab.texels; size != glm::ivec2(1);) {
        size = (size + 1) / 2;
        tables.mips.push_back({size, {}});
    }
    tables.cells = slab.grid + static_cast<int>(slab.profile.cells.size()) - 1;
    return tables;
}

/// How many values each array holds, in the order of arrays().
struct ArraySize {
    const char* name;
    std::size_t expected, actual;
};

std::size_t area(glm::ivec2 size) {
    return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
}

std::vector<ArraySize> array_sizes(const Slab& slab, const SlabTables& tables) {
    const std::size_t images = area(slab.grid), cells = area(shape_tables(slab).cells);
    const std::size_t corners = images * area(slab.texels + 1);
    return {{"total", images, tables.total.size()},
            {"median_s_m", images, tables.median_s_m.size()},
            {"sat_hi", corners, tables.sat_hi.size()},
            {"sat_lo", corners, tables.sat_lo.size()},
            {"marginal_cdf", images * area({slab.texels.x + 1, 1}), tables.marginal_cdf.size()},
            {"conditional_cdf", images * area({slab.texels.x, slab.texels.y + 1}),
             tables.conditional_cdf.size()},
            {"cells", cells, area(tables.cells)},
            {"cell_reference_s_m", cells, tables.cell_reference_s_m.size()},
            {"cell_total", cells, tables.cell_total.size()}};
}

std::size_t mip_value_count(const Slab& slab, glm::ivec2 texels) {
    return area(slab.grid) * area(texels) * static_cast<std::size_t>(slab.channels);
}

void resize(const Slab& slab, SlabTables& tables) {
    const std::size_t images = area(slab.grid), corners = images * area(slab.texels + 1);
    tables.total.resize(images);
    tables.median_s_m.resize(images);
    resize_large(tables.sat_hi, corners);
    resize_large(tables.sat_lo, corners);
    tables.marginal_cdf.resize(images * area({slab.texels.x + 1, 1}));
    resize_large(tables.conditional_cdf, images * area({slab.texels.x, slab.texels.y + 1}));
    for (MipLevel& mip : tables.mips)
        resize_large(mip.coeffs, mip_value_count(slab, mip.texels));
    tables.cell_reference_s_m.resize(area(tables.cells));
    tables.cell_total.resize(area(tables.cells));
}

void check_sizes(const Slab& slab, const SlabTables& tables, const std::string& where) {
    for (const ArraySize& size : array_sizes(slab, tables))
        if (size.expected != size.actual)
            throw Error{"bad tables", where + "." + size.name,
                        fmt::format("{} values", size.expected), fmt::format("{}", size.actual)};
    const std::vector<MipLevel> expected = shape_tables(slab).mips;
    if (tables.mips.size() != expected.size())
        throw Error{"bad tables", where + ".mips", fmt::format("{} levels", expected.size()),
                    fmt::format("{}", tables.mips.size())};
    for (std::size_t k = 0; k < expected.size(); ++k)
        if (tables.mips[k].texels != expected[k].texels ||
            tables.mips[k].coeffs.size() != mip_value_count(slab, expected[k].texels))
            throw Error{"bad tables", fmt::format("{}.mips[{}]", where, k),
                        fmt::format("{} x {} texels", expected[k].texels.x, expected[k].texels.y),
                        fmt::format("{} x {}, {} values", tables.mips[k].texels.x,
                                    tables.mips[k].texels.y, tables.mips[k].coeffs.size())};
}

}  // namespace

void write_luminaire(const Luminaire& luminaire,
                     const std::optional<RunRecord>& run,
                     const std::string& path) {
    const LightField& lightfield = luminaire.lightfield;
    check(lightfield, path);
    if (!luminaire.tables.empty() && luminaire.tables.size() != lightfield.slabs.size())
        throw Error{"bad tables", path,
                    fmt::format("one entry a slab ({})", lightfield.slabs.size()),
                    fmt::format("{}", luminaire.tables.size())};
    std::vector<exr::Atlas<const float>> atlases = lightfield_atlases(lightfield);
    for (std::size_t k = 0; k < luminaire.tables.size(); ++k) {
        check_sizes(lightfield.slabs[k], luminaire.tables[k],
                    fmt::format("{}, slabs[{}]", path, k));
        for (auto& atlas : table_atlases(k, lightfield.slabs[k], luminaire.tables[k]))
            atlases.push_back(std::move(atlas));
    }
    exr::Attributes attributes = provenance_attributes(lightfield.provenance, run);
    attributes.emplace_back(kLuminaireAttribute, describe(lightfield, {"luminaire", kFormatVersion},
                                                          !luminaire.tables.empty()));
    // Inflating would take several times as long as reading (docs/formats.md).
    exr::write(atlases, exr::Compression::None, attributes, path);
}

Luminaire read_luminaire(const std::string& path) {
    exr::Reader reader(path);
    Description description = read_lightfield_parts(reader, path);
    if (description.kind.kind != "luminaire")
        throw Error{"not a packed luminaire", path, "kind luminaire", description.kind.kind};
    Luminaire luminaire{std::move(description.lightfield), {}};
    if (!description.has_tables)
        return luminaire;
    const std::vector<Slab>& slabs = luminaire.lightfield.slabs;
    for (std::size_t k = 0; k < slabs.size(); ++k) {
        luminaire.tables.push_back(shape_tables(slabs[k]));
        for (const exr::Atlas<float>& atlas : table_atlases(k, slabs[k], luminaire.tables[k]))
            reader.require(atlas);
    }
    for (std::size_t k = 0; k < slabs.size(); ++k) {
        resize(slabs[k], luminaire.tables[k]);
        for (const exr::Atlas<float>& atlas : table_atlases(k, slabs[k], luminaire.tables[k]))
            reader.read(atlas);
    }
    return luminaire;
}

}  // namespace nearfield
