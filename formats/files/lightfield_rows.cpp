// SPDX-License-Identifier: Apache-2.0
#include "formats/files/lightfield_rows.h"

#include "formats/files/error.h"
#include "formats/files/exr_stream.h"
#include "formats/files/lightfield_parts.h"
#include "formats/files/metadata.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nearfield {
namespace {

std::size_t image_count(const Slab& slab) {
    return static_cast<std::size_t>(slab.channels) * static_cast<std::size_t>(slab.image_count());
}

}  // namespace

LightFieldRows::LightFieldRows(const Slab& slab, LightFieldTables tables, const std::string& folder)
    : slab_(slab), tables_(tables), file_(folder) {
    slab_.coeffs.clear();
    // describe() asks whether there are sigmas and how many replicates, not which.
    slab_.sigma.assign(tables.has_sigma ? 1 : 0, 0.0F);
    slab_.replicates.assign(static_cast<std::size_t>(tables.replicates), {});
    check_geometry(slab_, "slab");
    // The last value, so that rows that are never put can be read.
    const float zero = 0.0F;
    const std::uint64_t values = static_cast<std::uint64_t>(table_count()) * image_count(slab_) *
                                 static_cast<std::uint64_t>(slab_.texel_count());
    file_.write_at(&zero, sizeof zero, (values - 1) * sizeof(float));
}

void LightFieldRows::put(int first_row,
                         int row_count,
                         std::span<const float> coeffs,
                         std::span<const float> sigma) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    put_table(0, first_row, row_count, coeffs, kLargest);
    brightest_ = std::max(brightest_, *std::max_element(coeffs.begin(), coeffs.end()));
    if (tables_.has_sigma)
        put_table(1, first_row, row_count, sigma, std::numeric_limits<float>::infinity());
}

void LightFieldRows::put_replicate(int replicate,
                                   int first_row,
                                   int row_count,
                                   std::span<const float> coeffs) {
    put_table(first_replicate() + replicate, first_row, row_count, coeffs,
              std::numeric_limits<float>::max());
}

void LightFieldRows::put_table(
    int table, int first_row, int row_count, std::span<const float> values, float largest) {
    const auto width = static_cast<std::size_t>(slab_.texels.x);
    const std::size_t part = width * static_cast<std::size_t>(row_count);
    const std::size_t images = image_count(slab_);
    if (table >= table_count() || first_row < 0 || row_count < 1 ||
        first_row + row_count > slab_.texels.y || values.size() != images * part)
        throw Error{"bad rows of a light field",
                    fmt::format("table {}, rows from {}", table, first_row),
                    fmt::format("{} values in {} rows of {} tables", images * part, slab_.texels.y,
                                table_count()),
                    fmt::format("{} in {}", values.size(), row_count)};
    const auto bad = std::find_if(values.begin(), values.end(), [largest](float value) {
        return !(value >= 0.0F && value <= largest);
    });
    if (bad != values.end())
        throw Error{"bad value",
                    fmt::format("rows from {}, value {}", first_row, bad - values.begin()),
                    "finite and >= 0", fmt::format("{}", *bad)};
    const std::size_t first_image = static_cast<std::size_t>(table) * images;
    for (std::size_t image = 0; image < images; ++image)
        file_.write_at(values.data() + image * part, part * sizeof(float),
                       ((first_image + image) * slab_.texel_count() +
                        static_cast<std::size_t>(first_row) * width) *
                           sizeof(float));
}

void LightFieldRows::read(int table, int channel, int m, float* values) const {
    const auto image =
        static_cast<std::size_t>((table * slab_.channels + channel) * slab_.image_count() + m);
    const std::size_t bytes = slab_.texel_count() * sizeof(float);
    file_.read_at(values, bytes, image * bytes);
    if (table == 1 && tables_.has_sigma)
        for (std::size_t t = 0; t < slab_.texel_count(); ++t)
            values[t] = std::isinf(values[t]) ? brightest_ : values[t];
}

Slab LightFieldRows::image(int m) const {
    Slab image = slab_;
    image.u_center_m = slab_.basis_center_m(m % slab_.grid.x, m / slab_.grid.x);
    image.grid = {1, 1};
    const std::size_t texels = slab_.texel_count();
    const auto take = [&](int table, std::vector<float>& values) {
        values.resize(static_cast<std::size_t>(slab_.channels) * texels);
        for (int channel = 0; channel < slab_.channels; ++channel)
            read(table, channel, m, values.data() + static_cast<std::size_t>(channel) * texels);
    };
    take(0, image.coeffs);
    if (tables_.has_sigma)
        take(1, image.sigma);
    for (int r = 0; r < tables_.replicates; ++r)
        take(first_replicate() + r, image.replicates[static_cast<std::size_t>(r)]);
    return image;
}

void LightFieldRows::write(const LightField& about,
                           const std::optional<RunRecord>& run,
                           const std::string& path) const {
    LightField whole = about;
    whole.slabs = {slab_};
    exr::Attributes attributes = provenance_attributes(about.provenance, run);
    attributes.emplace_back(kLuminaireAttribute,
                            describe(whole, {"lightfield", kFormatVersion}, false));
    std::vector<exr::Atlas<const float>> atlases;
    const auto add = [&](const std::string& table) {
        atlases.push_back(
            image_atlas<const float>(part_name(0, table), slab_, slab_.texels, nullptr));
    };
    add("coeffs");
    if (tables_.has_sigma)
        add("sigma");
    for (int r = 0; r < tables_.replicates; ++r)
        add(replicate_table(static_cast<std::size_t>(r)));
    const auto fetch = [&](std::size_t atlas, std::size_t channel, int m, float* values) {
        read(static_cast<int>(atlas), static_cast<int>(channel), m, values);
    };
    exr::write_fetched(atlases, fetch, exr::Compression::Zip, attributes, path);
}

}  // namespace nearfield
