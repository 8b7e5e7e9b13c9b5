// SPDX-License-Identifier: Apache-2.0
#include "formats/files/lightfield.h"

#include "formats/files/error.h"
#include "formats/files/exr_file.h"
#include "formats/files/large_array.h"
#include "formats/files/lightfield_parts.h"
#include "formats/files/metadata.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <atomic>
#include <cmath>
#include <limits>

namespace nearfield {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

bool is_valid(float value) {
    return value >= 0.0F && value <= std::numeric_limits<float>::max();
}

std::size_t first_bad(const std::vector<float>& values) {
    constexpr std::size_t kBlock = 1 << 16;  // a fraction of the second-level cache
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, values.size(), kBlock), kNone,
        [&](const auto& range, std::size_t found) {
            int bad = 0;
            for (std::size_t k = range.begin(); k < range.end(); ++k)
                bad |= static_cast<int>(!is_valid(values[k]));
            if (bad == 0)
                return found;
            std::size_t k = range.begin();
            while (is_valid(values[k]))
                ++k;
            return std::min(found, k);
        },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
}

void check_values(const Slab& slab, const std::vector<float>& values, const std::string& where) {
    const std::size_t expected =
        slab.image_offset(slab.channels, 0);  // one past the last channel's last image
    if (values.size() != expected)
        throw Error{"bad slab", where, fmt::format("{} values", expected),
                    fmt::format("{}", values.size())};
    const std::size_t bad = first_bad(values);
    if (bad == kNone)
        return;
    const std::size_t image = bad / slab.texel_count(), texel = bad % slab.texel_count();
    const auto width = static_cast<std::size_t>(slab.texels.x);
    const auto images = static_cast<std::size_t>(slab.image_count());
    throw Error{
        "bad value",
        fmt::format("{}, image {}, texel ({}, {}), channel {}", where, image % images,
                    texel % width, texel / width, slab.channels == 1 ? 'Y' : "RGB"[image / images]),
        "finite and >= 0", fmt::format("{}", values[bad])};
}

void check_scale_sigma(double scale_sigma_rel, const std::string& where) {
    if (!(scale_sigma_rel >= 0.0 && std::isfinite(scale_sigma_rel)))
        throw Error{"bad light field", where + ".scale_sigma_rel", "a finite number >= 0",
                    fmt::format("{}", scale_sigma_rel)};
}

std::string require_description(const exr::Reader& reader, const std::string& path) {
    const std::optional<std::string> text = reader.attribute(kLuminaireAttribute);
    if (!text)
        throw Error{"not a light field or luminaire", path,
                    "EXR attribute '" + kLuminaireAttribute + "' in the first part"};
    return *text;
}

}  // namespace

void check(const LightField& lightfield, const std::string& where) {
    if (lightfield.slabs.empty())
        throw Error{"bad light field", where, "at least one slab"};
    check_scale_sigma(lightfield.scale_sigma_rel, where);
    for (std::size_t k = 0; k < lightfield.slabs.size(); ++k) {
        const Slab& slab = lightfield.slabs[k];
        const std::string place = fmt::format("{}, slabs[{}]", where, k);
        check_geometry(slab, place);
        check_values(slab, slab.coeffs, place + ".coeffs");
        if (!slab.sigma.empty())
            check_values(slab, slab.sigma, place + ".sigma");
        for (std::size_t r = 0; r < slab.replicates.size(); ++r)
            check_values(slab, slab.replicates[r], fmt::format("{}.replicates[{}]", place, r));
        if (slab.replicates.size() != lightfield.slabs.front().replicates.size())
            throw Error{"bad light field", place + ".replicates",
                        fmt::format("{}, as slab 0", lightfield.slabs.front().replicates.size()),
                        fmt::format("{}", slab.replicates.size())};
    }
}

std::vector<exr::Atlas<const float>> lightfield_atlases(const LightField& lightfield) {
    std::vector<exr::Atlas<const float>> atlases;
    for (std::size_t k = 0; k < lightfield.slabs.size(); ++k) {
        const Slab& slab = lightfield.slabs[k];
        atlases.push_back(
            image_atlas(part_name(k, "coeffs"), slab, slab.texels, slab.coeffs.data()));
        if (!slab.sigma.empty())
            atlases.push_back(
                image_atlas(part_name(k, "sigma"), slab, slab.texels, slab.sigma.data()));
        for (std::size_t r = 0; r < slab.replicates.size(); ++r)
            atlases.push_back(image_atlas(part_name(k, replicate_table(r)), slab, slab.texels,
                                          slab.replicates[r].data()));
    }
    return atlases;
}

void write_lightfield(const LightField& lightfield,
                      const std::optional<RunRecord>& run,
                      const std::string& path) {
    check(lightfield, path);
    exr::Attributes attributes = provenance_attributes(lightfield.provenance, run);
    attributes.emplace_back(kLuminaireAttribute,
                            describe(lightfield, {"lightfield", kFormatVersion}, false));
    exr::write(lightfield_atlases(lightfield), exr::Compression::Zip, attributes, path);
}

bool holds_luminaire(const std::string& path) {
    return exr::Reader(path).attribute(kLuminaireAttribute).has_value();
}

FileKind read_kind(const std::string& path) {
    const exr::Reader reader(path);
    return parse_kind(require_description(reader, path), path + ", " + kLuminaireAttribute);
}

Description read_lightfield_parts(exr::Reader& reader,
                                  const std::string& path,
                                  exr::Values accepted) {
    const std::string where = path + ", " + kLuminaireAttribute;
    Description description = parse_description(require_description(reader, path), where);
    LightField& lightfield = description.lightfield;
    check_scale_sigma(lightfield.scale_sigma_rel, where);
    lightfield.provenance = read_provenance(reader, path);

    // All parts are checked before the first is allocated.
    for (const bool is_reading : {false, true}) {
        for (std::size_t k = 0; k < lightfield.slabs.size(); ++k) {
            Slab& slab = lightfield.slabs[k];
            const auto take = [&](const std::string& table, std::vector<float>& values) {
                if (is_reading)
                    resize_large(values, slab.image_offset(slab.channels, 0));
                exr::Atlas<float> atlas =
                    image_atlas(part_name(k, table), slab, slab.texels, values.data());
                atlas.values = accepted;
                if (is_reading)
                    reader.read(atlas);
                else
                    reader.require(atlas);
            };
            take("coeffs", slab.coeffs);
            if (description.has_sigma[k])
                take("sigma", slab.sigma);
            slab.replicates.resize(description.replicate_count[k]);
            for (std::size_t r = 0; r < slab.replicates.size(); ++r)
                take(replicate_table(r), slab.replicates[r]);
        }
    }
    return description;
}

LightField read_lightfield(const std::string& path) {
    exr::Reader reader(path);
    return read_lightfield_parts(reader, path).lightfield;
}

}  // namespace nearfield
