// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/zemax.h"

#include "formats/files/error.h"
#include "formats/rays/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::rays {
namespace {

constexpr std::uint64_t kFluxByte = 108, kUnitsByte = 136, kPlacementByte = 140,
                        kRayFormatByte = 192;
constexpr std::int32_t kFluxOnly = 0, kSpectral = 2;
constexpr double kNmPerUm = 1000;
constexpr std::uint64_t kLongestHeaderLine = 1024;

double meters_per_unit(std::int64_t unit, const std::string& where) {
    if (unit < 0 || unit >= static_cast<std::int64_t>(kZemaxMetersPerUnit.size()))
        throw Error{"unknown unit of length in ray file", where, "0 ... 4 (m, in, cm, feet, mm)",
                    fmt::format("{}", unit)};
    return kZemaxMetersPerUnit[static_cast<std::size_t>(unit)];
}

// The help says that the header's shift and turn of the source change nothing; whoever wrote them
// may have meant it otherwise.
void note_placement(ByteReader& file, RayLayout& layout) {
    std::array<float, 6> shift_and_turn{};
    file.seek(kPlacementByte);
    file.read(shift_and_turn.data(), sizeof shift_and_turn);
    if (std::any_of(shift_and_turn.begin(), shift_and_turn.end(),
                    [](float value) { return value != 0; }))
        layout.notes.emplace_back(
            "the header's translation and rotation of the source are not applied, as OpticStudio "
            "does not");
}

// The numbers of the first line, or none where they are not numbers.
std::vector<double> first_line(ByteReader& file) {
    const std::string head = file.head(kLongestHeaderLine);
    return numbers_of(std::string_view(head).substr(0, head.find('\n')))
        .value_or(std::vector<double>{});
}

bool is_whole(double value) {
    return value == std::floor(value);
}

}  // namespace

bool is_zemax_binary(ByteReader& file) {
    return file.starts_with(std::string_view("\xF2\x03\0\0", 4));
}

bool is_zemax_text(ByteReader& file) {
    const std::vector<double> numbers = first_line(file);
    return numbers.size() >= 2 && numbers.size() <= 8 && is_whole(numbers[0]) && numbers[0] >= 0 &&
           is_whole(numbers[1]) && numbers[1] >= 0;
}

RayLayout read_zemax_header(ByteReader& file) {
    RayLayout layout;
    layout.format = "Zemax";
    file.need(kZemaxHeaderBytes);
    file.seek(4);
    layout.ray_count = file.read<std::uint32_t>();
    file.seek(kFluxByte);
    const auto source_flux = file.read<float>();
    file.read<float>();  // of this file's share of the rays
    const auto wavelength_um = file.read<float>();
    file.seek(kUnitsByte);
    layout.m_per_unit = meters_per_unit(file.read<std::int32_t>(), file.at(kUnitsByte));
    note_placement(file, layout);
    file.seek(kRayFormatByte);
    const auto ray_format = file.read<std::int32_t>(), flux_type = file.read<std::int32_t>();
    if (ray_format != kFluxOnly && ray_format != kSpectral)
        throw Error{"unknown kind of rays in ray file", file.at(kRayFormatByte),
                    "0 (flux) or 2 (flux and wavelength)", std::to_string(ray_format)};
    if (flux_type != 0 && flux_type != 1)
        throw Error{"unknown kind of flux in ray file", file.at(kRayFormatByte + 4),
                    "0 (W) or 1 (lm)", std::to_string(flux_type)};
    (flux_type == 1 ? layout.luminous : layout.radiant) = 6;
    (flux_type == 1 ? layout.luminous_flux_lm : layout.radiant_flux_w) = source_flux;
    layout.columns = 7;
    layout.nm_per_unit = kNmPerUm;
    if (ray_format == kSpectral)
        layout.wavelength = layout.columns++;
    else if (wavelength_um > 0 && std::isfinite(wavelength_um)) {
        layout.has_wavelength_for_all = true;
        layout.wavelength_nm = kNmPerUm * wavelength_um;
    }
    layout.data_byte = kZemaxHeaderBytes;
    file.seek(layout.data_byte);
    check_length(file, layout);
    return layout;
}

RayLayout read_zemax_text_header(ByteReader& file) {
    RayLayout layout;
    layout.format = "Zemax (text)";
    layout.is_text = true;
    const std::vector<double> first = first_line(file);
    constexpr double kMostRays = 4e9;
    if (!(first[0] >= 1 && first[0] <= kMostRays))
        throw Error{"ray file without rays", file.at(0), "1 ... 4e9 rays",
                    fmt::format("{:g}", first[0])};
    layout.ray_count = static_cast<std::uint64_t>(first[0]);
    layout.m_per_unit =
        meters_per_unit(static_cast<std::int64_t>(std::min(first[1], 1e6)), file.at(0));
    const std::string head = file.head(2 * kLongestHeaderLine);
    const std::size_t row = head.find('\n') + 1;
    const auto numbers = numbers_of(std::string_view(head).substr(row, head.find('\n', row) - row));
    if (head.find('\n') == std::string::npos || !numbers ||
        (numbers->size() != 7 && numbers->size() != 8))
        throw Error{"ray file without rays", file.at(row), "a line of 7 or 8 numbers",
                    numbers ? fmt::format("{}", numbers->size()) : "text"};
    layout.radiant = 6;
    layout.columns = numbers->size();
    layout.nm_per_unit = kNmPerUm;
    if (layout.columns == 8)
        layout.wavelength = 7;
    layout.data_byte = row;
    return layout;
}

}  // namespace nearfield::rays
