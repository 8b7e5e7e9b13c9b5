// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/tm25.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace nearfield::rays {
namespace {

constexpr std::uint64_t kColumnNameBytes = 512;  // section 4.7.5

// What the header says and the layout does not: it is turned into columns.
struct Tm25Header {
    std::int32_t spectral_data =
        0;  // 0 none, 1 one wavelength, 2 one a ray, 3 one table, 4 a table a ray
    float wavelength_nm = 0;
    bool has_radiant = false, has_wavelength = false, has_luminous = false, has_stokes = false;
    bool has_tristimulus = false, has_spectrum_index = false;
    std::vector<SpectralTable> tables;
    std::uint64_t additional_items = 0;
};

void place_columns(const Tm25Header& header, RayLayout& layout) {
    const auto place = [&layout](bool present) {
        return present ? std::optional<std::size_t>(layout.columns++) : std::nullopt;
    };
    layout.radiant = place(header.has_radiant);
    const auto wavelength = place(header.has_wavelength);
    layout.luminous = place(header.has_luminous);
    if (header.has_stokes)
        layout.columns += 6;  // S1, S2, S3 and the reference axis, not needed here
    layout.tristimulus_x = place(header.has_tristimulus);
    layout.tristimulus_z = place(header.has_tristimulus);
    const auto spectrum = place(header.has_spectrum_index);
    layout.columns += header.additional_items;
    if (header.spectral_data == 2)
        layout.wavelength = wavelength;
    if (header.spectral_data == 4)
        layout.spectrum = spectrum;
    layout.has_wavelength_for_all = header.spectral_data == 1;
    layout.wavelength_nm = header.wavelength_nm;
    if (header.spectral_data >= 3)
        layout.tables = header.tables;
}

std::int32_t read_flag(ByteReader& file, const char* name) {
    const std::uint64_t byte = file.position();
    const auto value = file.read<std::int32_t>();
    if (value != 0 && value != 1)
        throw Error{fmt::format("bad {} flag in ray file", name), file.at(byte), "0 or 1",
                    std::to_string(value)};
    return value;
}

std::int32_t read_count(ByteReader& file, const char* name, std::int32_t least) {
    const std::uint64_t byte = file.position();
    const auto value = file.read<std::int32_t>();
    if (value < least)
        throw Error{fmt::format("bad {} in ray file", name), file.at(byte),
                    fmt::format(">= {}", least), std::to_string(value)};
    return value;
}

void read_flags(ByteReader& file, Tm25Header& header) {
    file.seek(kTm25FlagsByte);
    if (read_flag(file, "position") + read_flag(file, "direction") != 2)
        throw Error{"ray file without positions or directions", file.at(kTm25FlagsByte),
                    "flags 1, 1"};
    header.has_radiant = read_flag(file, "radiant flux") == 1;
    header.has_wavelength = read_flag(file, "wavelength") == 1;
    header.has_luminous = read_flag(file, "luminous flux") == 1;
    header.has_stokes = read_flag(file, "Stokes") == 1;
    header.has_tristimulus = read_flag(file, "tristimulus") == 1;
    header.has_spectrum_index = read_flag(file, "spectrum index") == 1;
    if (!header.has_radiant && !header.has_luminous)
        throw Error{"ray file without flux", file.at(kTm25FlagsByte + 8),
                    "the radiant or the luminous flux flag set"};
}

void read_tables(ByteReader& file, Tm25Header& header, std::int32_t table_count) {
    file.seek(kTm25TablesByte);
    for (std::int32_t t = 0; t < table_count; ++t) {
        const auto pairs = static_cast<std::uint64_t>(read_count(file, "spectral table's size", 1));
        file.need(pairs * 8);
        SpectralTable table;
        for (std::uint64_t p = 0; p < pairs; ++p) {
            const std::uint64_t byte = file.position();
            table.wavelength_nm.push_back(file.read<float>());
            table.weight.push_back(file.read<float>());
            const float l = table.wavelength_nm.back();
            const bool rises = p == 0 || l > table.wavelength_nm[p - 1];
            if (!std::isfinite(l) || l <= 0 || !rises || !std::isfinite(table.weight.back()) ||
                table.weight.back() < 0)
                throw Error{"bad entry of a spectral table", file.at(byte),
                            "rising wavelengths > 0 and finite weights >= 0",
                            fmt::format("{} nm, {}", l, table.weight.back())};
        }
        header.tables.push_back(std::move(table));
    }
    // Padding to a multiple of 32 bytes.
    file.seek(kTm25TablesByte + (file.position() - kTm25TablesByte + 31) / 32 * 32);
}

void check_spectral_data(const ByteReader& file, const Tm25Header& header) {
    const auto refuse = [&](const char* expected) {
        throw Error{"contradictory spectral data in ray file", file.at(60), expected,
                    fmt::format("identifier {}", header.spectral_data)};
    };
    if (header.spectral_data < 0 || header.spectral_data > 4)
        refuse("identifier 0 ... 4");
    if (header.spectral_data == 1 && !(header.wavelength_nm > 0))
        refuse("a wavelength > 0 at byte 64");
    if (header.spectral_data == 2 && !header.has_wavelength)
        refuse("a wavelength with every ray");
    if (header.spectral_data >= 3 && header.tables.empty())
        refuse("a spectral table");
    if (header.spectral_data == 4 && !header.has_spectrum_index)
        refuse("a spectrum index with every ray");
    if (header.has_tristimulus && !header.has_luminous)
        refuse("luminous flux (Y) beside tristimulus X and Z");
}

}  // namespace

bool is_tm25(ByteReader& file) {
    return file.starts_with("TM25");
}

RayLayout read_tm25_header(ByteReader& file) {
    RayLayout layout;
    layout.format = "IES TM-25";
    file.seek(4);
    const auto version = file.read<std::int32_t>();
    if (version != kTm25Version)
        throw Error{"unknown version of a ray file", file.at(4), std::to_string(kTm25Version),
                    std::to_string(version)};
    Tm25Header header;
    file.seek(12);  // byte 8: simulated or measured
    layout.luminous_flux_lm = file.read<float>();
    layout.radiant_flux_w = file.read<float>();
    layout.ray_count = file.read<std::uint64_t>();
    file.seek(60);  // date and where rays start: nothing depends on them
    header.spectral_data = file.read<std::int32_t>();
    header.wavelength_nm = file.read<float>();
    file.seek(76);
    const auto table_count = read_count(file, "number of spectral tables", 0);
    header.additional_items =
        static_cast<std::uint64_t>(read_count(file, "number of additional items", 0));
    const auto text_bytes =
        static_cast<std::uint64_t>(read_count(file, "size of the additional text", 0));
    read_flags(file, header);
    read_tables(file, header, table_count);
    check_spectral_data(file, header);
    place_columns(header, layout);
    layout.data_byte = file.position() + header.additional_items * kColumnNameBytes + text_bytes;
    file.seek(layout.data_byte);
    check_length(file, layout);
    return layout;
}

}  // namespace nearfield::rays
