// SPDX-License-Identifier: Apache-2.0
#include "tests/files/sample_lightfield.h"

#include "formats/files/error.h"

#include <fstream>
#include <numeric>
#include <sstream>

namespace nearfield::test {
namespace {

std::vector<float> ramp(std::size_t count, float first) {
    std::vector<float> values(count);
    std::iota(values.begin(), values.end(), first);
    return values;
}

std::vector<glm::vec2> ramp_pairs(int count, float first) {
    std::vector<glm::vec2> values;
    values.reserve(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k)
        values.emplace_back(first + static_cast<float>(k), -first - 0.5F * static_cast<float>(k));
    return values;
}

SlabTables sample_tables(const Slab& slab) {
    const auto images = static_cast<std::size_t>(slab.image_count());
    const auto w = static_cast<std::size_t>(slab.texels.x);
    const auto h = static_cast<std::size_t>(slab.texels.y);
    SlabTables tables;
    tables.total = ramp(images, 1);
    tables.median_s_m = ramp_pairs(slab.image_count(), 2);
    tables.sat_hi = ramp(images * (w + 1) * (h + 1), 3);
    tables.sat_lo = ramp(images * (w + 1) * (h + 1), -4);
    tables.marginal_cdf = ramp(images * (w + 1), 5);
    tables.conditional_cdf = ramp(images * w * (h + 1), 6);
    for (glm::ivec2 size = slab.texels; size != glm::ivec2(1);) {
        size = (size + 1) / 2;
        tables.mips.push_back(
            {size, ramp(static_cast<std::size_t>(size.x * size.y * slab.channels) * images, 7)});
    }
    tables.cells = slab.grid + static_cast<int>(slab.profile.cells.size()) - 1;
    const int cell_count = tables.cells.x * tables.cells.y;
    tables.cell_reference_s_m = ramp_pairs(cell_count, 8);
    tables.cell_total = ramp(static_cast<std::size_t>(cell_count), 9);
    return tables;
}

}  // namespace

Slab sample_slab(const SampleShape& shape) {
    Slab slab;
    // A quarter turn about y, so that rows and columns of the rotation cannot be mixed up unseen.
    slab.luminaire_from_slab.rotation = glm::dmat3(0, 0, -1, 0, 1, 0, 1, 0, 0);
    slab.luminaire_from_slab.translation_m = {0.01, -0.02, 0.03};
    slab.delta_m = 0.2;
    slab.grid = shape.grid;
    slab.pitch_m = {0.0165, 0.0123456789012345678};
    slab.u_center_m = {0.001, -1.0 / 3.0};
    slab.texels = shape.texels;
    slab.s_min_m = {-0.1, -0.05};
    slab.s_max_m = {0.12, 0.07};
    slab.profile = {"bspline", {{1.125, 1.5, 0.5}, {0.75, 0.0, -1.0}, {1.125, -1.5, 0.5}}};
    slab.channels = shape.channels;
    slab.coeffs = ramp(slab.image_offset(shape.channels, 0), 0.25F);
    if (shape.has_sigma)
        slab.sigma = ramp(slab.coeffs.size(), 0.125F);
    return slab;
}

LightField sample_lightfield() {
    LightField lightfield;
    lightfield.quantity = Quantity::Radiometric;
    lightfield.scale_sigma_rel = 0.015;
    lightfield.slabs.push_back(sample_slab({{3, 2}, {5, 4}, 3, true}));
    lightfield.slabs.push_back(sample_slab({{1, 4}, {2, 3}, 1, false}));
    lightfield.slabs[1].weighting = Weighting::Radiance;
    lightfield.slabs[1].profile = {"measured", {{0.1, 0.2, 0.30000000000000004}}};
    lightfield.provenance = {
        "nearfield test",
        "convert",
        {{"grid", "3x2"}, {"grid", "again"}, {"note", "a \"quoted\" \xC3\xA9"}},
        {{"led.tm25ray", "0123456789abcdef0123456789abcdef"}},
        {{"flux_dropped_lm", 0.1}}};
    return lightfield;
}

Luminaire sample_luminaire() {
    Luminaire luminaire{sample_lightfield(), {}};
    for (const Slab& slab : luminaire.lightfield.slabs)
        luminaire.tables.push_back(sample_tables(slab));
    return luminaire;
}

std::string read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
}

std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace nearfield::test
