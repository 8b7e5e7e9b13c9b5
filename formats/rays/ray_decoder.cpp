// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/ray_decoder.h"

#include "formats/files/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace nearfield::rays {

RayDecoder::RayDecoder(const RayLayout& layout, bool keep_radiometric) : layout_(layout) {
    flux_column_ = layout.luminous ? *layout.luminous : *layout.radiant;
    checked_ = {0, 1, 2, 3, 4, 5};
    for (const auto& column : {layout.radiant, layout.wavelength, layout.luminous,
                               layout.tristimulus_x, layout.tristimulus_z, layout.spectrum})
        if (column)
            checked_.push_back(*column);
    if (layout.has_wavelength_for_all)
        lights_.push_back(monochromatic(layout.wavelength_nm));
    for (const SpectralTable& table : layout.tables)
        lights_.push_back(integrate(table));
    has_own_light_ = layout.wavelength || layout.spectrum || layout.tristimulus_x;
    const bool knows_light = has_own_light_ || !lights_.empty();
    to_luminous_ = !layout.luminous && knows_light && !keep_radiometric;
    photometric_ = layout.luminous || to_luminous_;
    if (!photometric_)
        has_own_light_ = false;  // colors are of luminous flux
    else if (knows_light && !has_own_light_)
        shared_color_.push_back(lights_.front().color);
}

RayDecoder::Light RayDecoder::monochromatic(double wavelength_nm) {
    const glm::dvec3 xyz = color_matching(wavelength_nm);
    return {unit_color(xyz), kPeakEfficacyLmPerW * xyz.y};
}

// Trapezoidal rule over the table, as TM-25 connects its points by straight lines.
RayDecoder::Light RayDecoder::integrate(const SpectralTable& table) {
    glm::dvec3 xyz{0.0};
    double power = 0.0;
    for (std::size_t i = 0; i < table.weight.size(); ++i) {
        const double l = table.wavelength_nm[i];
        const double below = i > 0 ? l - table.wavelength_nm[i - 1] : 0.0;
        const double above = i + 1 < table.weight.size() ? table.wavelength_nm[i + 1] - l : 0.0;
        const double share =
            table.weight.size() == 1 ? 1.0 : 0.5 * (below + above) * table.weight[i];
        xyz += share * color_matching(l);
        power += share;
    }
    return {unit_color(xyz), power > 0 ? kPeakEfficacyLmPerW * xyz.y / power : 0.0};
}

const char* RayDecoder::complaint_of(const float* row) const {
    constexpr double kShortest = 1e-12;
    if (!std::all_of(checked_.begin(), checked_.end(),
                     [row](std::size_t column) { return std::isfinite(row[column]); }))
        return "ray file holds a number that is not finite";
    if (!(glm::length(glm::dvec3(row[3], row[4], row[5])) > kShortest))
        return "ray without direction";
    if (row[flux_column_] < 0)
        return "negative flux in ray file";
    if (layout_.spectrum && !(row[*layout_.spectrum] >= 1 &&
                              row[*layout_.spectrum] <= static_cast<float>(layout_.tables.size())))
        return "ray with an unknown spectrum";
    return nullptr;
}

RayDecoder::Light RayDecoder::light_of(const float* row) const {
    if (layout_.tristimulus_x)
        return {unit_color({row[*layout_.tristimulus_x], row[*layout_.luminous],
                            row[*layout_.tristimulus_z]}),
                0.0};
    if (layout_.wavelength)
        return monochromatic(layout_.nm_per_unit * row[*layout_.wavelength]);
    return lights_[static_cast<std::size_t>(row[*layout_.spectrum]) - 1];
}

Ray RayDecoder::ray_of(const float* row, double flux) const {
    const glm::dvec3 position(row[0], row[1], row[2]), direction(row[3], row[4], row[5]);
    return {glm::vec3(layout_.m_per_unit * position + layout_.origin_m),
            glm::vec3(direction / glm::length(direction)), static_cast<float>(flux)};
}

RayDecoder::Sums RayDecoder::decode_rows(const RayRows& rows,
                                         std::size_t begin,
                                         std::size_t end,
                                         RayChunk& chunk) const {
    Sums sums;
    for (std::size_t r = begin; r < end && sums.is_well; ++r) {
        const float* row = &rows.values[r * layout_.columns];
        sums.is_well = complaint_of(row) == nullptr;
        if (!sums.is_well)
            break;
        const double stored = row[flux_column_];
        Light light;
        if (has_own_light_) {
            light = light_of(row);
            chunk.colors[r] = light.color.rgb;
            sums.desaturated += light.color.desaturated ? 1 : 0;
        } else if (to_luminous_) {
            light = lights_.front();
        }
        const double flux = to_luminous_ ? stored * light.lm_per_w : stored;
        chunk.rays[r] = ray_of(row, flux);
        sums.flux += flux;
        sums.stored_flux += stored;
    }
    return sums;
}

void RayDecoder::decode(const RayRows& rows, const RowReader& reader, RayChunk& chunk) const {
    constexpr std::size_t kBlock = 4096;
    const std::size_t blocks = (rows.count + kBlock - 1) / kBlock;
    chunk.rays.resize(rows.count);
    chunk.colors.resize(has_own_light_ ? rows.count : 0);
    std::vector<Sums> sums(blocks);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        sums[b] = decode_rows(rows, b * kBlock, std::min(rows.count, (b + 1) * kBlock), chunk);
    });
    chunk.flux = chunk.stored_flux = 0;
    chunk.desaturated = 0;
    for (std::size_t b = 0; b < blocks; ++b) {  // in order: the same sums on any number of threads
        for (std::size_t r = b * kBlock; !sums[b].is_well; ++r)
            if (const char* complaint = complaint_of(&rows.values[r * layout_.columns]))
                throw Error{
                    complaint, reader.where(rows, r),
                    "finite numbers, a direction of unit length, flux >= 0",
                    fmt::format("{}", fmt::join(&rows.values[r * layout_.columns],
                                                &rows.values[r * layout_.columns] + layout_.columns,
                                                ", "))};
        chunk.flux += sums[b].flux;
        chunk.stored_flux += sums[b].stored_flux;
        chunk.desaturated += sums[b].desaturated;
    }
}

}  // namespace nearfield::rays
