// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/lighttools.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <array>

namespace nearfield::rays {
namespace {

constexpr std::uint32_t kVersion = 2, kVersionWithPolarization = 3;
// By LengthUnits, from 1: mm, cm, m, in, feet, um, nm. 0: the model's own.
constexpr std::array<double, 8> kMetersPerUnit = {1e-3, 1e-3, 1e-2, 1, 0.0254, 0.3048, 1e-6, 1e-9};
constexpr std::uint32_t kWavelengths = 2;

// A field of the header that must be one of 0 ... most.
std::uint32_t read_choice(ByteReader& file,
                          const char* name,
                          std::uint32_t most,
                          const char* expected) {
    const std::uint64_t byte = file.position();
    const auto value = file.read<std::uint32_t>();
    if (value > most)
        throw Error{fmt::format("{} of ray file", name), file.at(byte), expected,
                    std::to_string(value)};
    return value;
}

std::uint32_t read_version(ByteReader& file) {
    const auto version = file.read<std::uint32_t>();
    if (version != kVersion && version != kVersionWithPolarization)
        throw Error{"unknown version of a ray file", file.at(4), "2 or 3", std::to_string(version)};
    file.read<std::uint32_t>();  // minor
    return version;
}

}  // namespace

bool is_lighttools_binary(ByteReader& file) {
    return file.starts_with(kLightToolsMagic);
}

RayLayout read_lighttools_header(ByteReader& file) {
    RayLayout layout;
    layout.format = "LightTools";
    file.seek(kLightToolsMagic.size());
    const std::uint32_t version = read_version(file);
    const bool is_luminous = read_choice(file, "kind of flux", 1, "0 (W) or 1 (lm)") == 1;
    read_choice(file, "far field", 0, "0: rays with positions");
    const std::uint64_t color_byte = file.position();
    const auto color = file.read<std::uint32_t>();
    if (color != 0 && color != kWavelengths)
        throw Error{"kind of color of ray file", file.at(color_byte), "0 (none) or 2 (wavelengths)",
                    std::to_string(color)};
    const std::uint32_t unit =
        read_choice(file, "unit of length", kMetersPerUnit.size() - 1, "0 ... 7");
    layout.m_per_unit = kMetersPerUnit[unit];
    if (unit == 0)
        layout.notes.emplace_back("the header leaves the unit of length open: taken as mm");
    for (int k = 0; k < 3; ++k)
        layout.origin_m[k] = layout.m_per_unit * static_cast<double>(file.read<float>());
    (is_luminous ? layout.luminous_flux_lm : layout.radiant_flux_w) = file.read<float>();
    if (version == kVersionWithPolarization)
        read_choice(file, "polarization", 0, "0: none");
    (is_luminous ? layout.luminous : layout.radiant) = 6;
    layout.columns = 7;
    if (color == kWavelengths)
        layout.wavelength = layout.columns++;
    layout.data_byte = file.position();

    const std::uint64_t row_bytes = layout.columns * sizeof(float);
    const std::uint64_t rest = file.remaining();
    const bool has_end = rest >= kLightToolsEnd.size() && file.ends_with(kLightToolsEnd);
    const std::uint64_t rows = has_end ? rest - kLightToolsEnd.size() : rest;
    layout.ray_count = rows / row_bytes;
    if (!has_end || rows % row_bytes != 0)
        throw Error{"ray file is truncated",
                    fmt::format("{}, ray {}", file.at(file.size()), layout.ray_count),
                    fmt::format("rays of {} bytes, then 'LTRFEND'", row_bytes),
                    fmt::format("{} whole rays and {} bytes", layout.ray_count, rows % row_bytes)};
    if (layout.ray_count == 0)
        throw Error{"ray file without rays", file.at(layout.data_byte), ">= 1 ray", "'LTRFEND'"};
    return layout;
}

}  // namespace nearfield::rays
