// SPDX-License-Identifier: Apache-2.0
#include "formats/files/lightfield_rows.h"

#include "formats/files/error.h"
#include "formats/files/exr_stream.h"
#include "formats/files/lightfield_parts.h"
#include "formats/files/metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield {
namespace {

std::size_t image_count(const Slab& slab) {
    return static_cast<std::size_t>(slab.channels) * static_cast<std::size_t>(slab.image_count());
}

// The slab's parts as they stand in the file, without data.
std::vector<exr::Atlas<const float>> empty_atlases(const Slab& slab, bool has_sigma) {
    std::vector<exr::Atlas<const float>> atlases;
    for (const char* table : {"coeffs", "sigma"})
        if (has_sigma || atlases.empty())
            atlases.push_back(
                image_atlas<const float>(part_name(0, table), slab, slab.texels, nullptr));
    return atlases;
}

}  // namespace

LightFieldRows::LightFieldRows(const Slab& slab, bool has_sigma, const std::string& folder)
    : slab_(slab), has_sigma_(has_sigma), file_(folder) {
    slab_.coeffs.clear();
    // describe() asks whether there are sigmas, not which.
    slab_.sigma.assign(has_sigma ? 1 : 0, 0.0F);
    check_geometry(slab_, "slab");
    // The last value, so that rows that are never put can be read.
    const float zero = 0.0F;
    const std::uint64_t values =
        (has_sigma ? 2 : 1) * image_count(slab_) * static_cast<std::uint64_t>(slab_.texel_count());
    file_.write_at(&zero, sizeof zero, (values - 1) * sizeof(float));
}

void LightFieldRows::put(int first_row,
                         int row_count,
                         std::span<const float> coeffs,
                         std::span<const float> sigma) {
    put(Table::Coeffs, first_row, row_count, coeffs);
    if (has_sigma_)
        put(Table::Sigma, first_row, row_count, sigma);
}

void LightFieldRows::put(Table table, int first_row, int row_count, std::span<const float> values) {
    const auto width = static_cast<std::size_t>(slab_.texels.x);
    const std::size_t part = width * static_cast<std::size_t>(row_count);
    const std::size_t images = image_count(slab_);
    if (first_row < 0 || row_count < 1 || first_row + row_count > slab_.texels.y ||
        values.size() != images * part)
        throw Error{"bad rows of a light field", fmt::format("rows from {}", first_row),
                    fmt::format("{} values in {} rows", images * part, slab_.texels.y),
                    fmt::format("{} in {}", values.size(), row_count)};
    const auto bad = std::find_if(values.begin(), values.end(), [](float value) {
        return !(value >= 0.0F && std::isfinite(value));
    });
    if (bad != values.end())
        throw Error{"bad value",
                    fmt::format("rows from {}, value {}", first_row, bad - values.begin()),
                    "finite and >= 0", fmt::format("{}", *bad)};
    const std::size_t first_image = table == Table::Sigma ? images : 0;
    for (std::size_t image = 0; image < images; ++image)
        file_.write_at(values.data() + image * part, part * sizeof(float),
                       ((first_image + image) * slab_.texel_count() +
                        static_cast<std::size_t>(first_row) * width) *
                           sizeof(float));
}

void LightFieldRows::read(Table table, std::size_t image, float* values) const {
    const std::size_t first_image = table == Table::Sigma ? image_count(slab_) : 0;
    const std::size_t bytes = slab_.texel_count() * sizeof(float);
    file_.read_at(values, bytes, (first_image + image) * bytes);
}

std::vector<float> LightFieldRows::image(int channel, int m) const {
    std::vector<float> values(slab_.texel_count());
    read(Table::Coeffs, static_cast<std::size_t>(channel * slab_.image_count() + m), values.data());
    return values;
}

void LightFieldRows::write(const LightField& about,
                           const std::optional<RunRecord>& run,
                           const std::string& path) const {
    LightField whole = about;
    whole.slabs = {slab_};
    exr::Attributes attributes = provenance_attributes(about.provenance, run);
    attributes.emplace_back(kLuminaireAttribute,
                            describe(whole, {"lightfield", kFormatVersion}, false));
    const auto fetch = [&](std::size_t atlas, std::size_t channel, int m, float* values) {
        const std::size_t images = channel * static_cast<std::size_t>(slab_.image_count());
        read(atlas == 0 ? Table::Coeffs : Table::Sigma, images + static_cast<std::size_t>(m),
             values);
    };
    exr::write_fetched(empty_atlases(slab_, has_sigma_), fetch, exr::Compression::Zip, attributes,
                       path);
}

}  // namespace nearfield
