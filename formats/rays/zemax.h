// SPDX-License-Identifier: Apache-2.0
/// The headers of Zemax source files (.dat, .sdf), binary and text. Source: OpticStudio's help,
/// "Source File": a header of 208 bytes, then seven floats a ray, or eight with a wavelength in um;
/// in text a first line with the number of rays and the unit, then the same numbers, a ray a line.
/// OpticStudio itself uses the number of rays, units and types alone; the flux of the source, where
/// stated, scales the rays here as that of TM-25 does.
#pragma once

#include "formats/rays/byte_reader.h"
#include "formats/rays/ray_layout.h"

#include <array>

namespace nearfield::rays {

constexpr std::uint64_t kZemaxHeaderBytes = 208, kZemaxTextBytes = 100;
constexpr std::int32_t kZemaxIdentifier = 1010;
/// By DimensionUnits: m, in, cm, feet, mm.
constexpr std::array<double, 5> kZemaxMetersPerUnit = {1, 0.0254, 0.01, 0.3048, 0.001};
constexpr std::int32_t kZemaxMm = 4;

bool is_zemax_binary(ByteReader& file);
/// The first line is 2 ... 8 numbers, of which the first is a count and the second a unit.
bool is_zemax_text(ByteReader& file);

/// Throws Error naming byte offset (and ray) where the header is not as described, or promises rays
/// that the file's size does not justify.
RayLayout read_zemax_header(ByteReader& file);
RayLayout read_zemax_text_header(ByteReader& file);

}  // namespace nearfield::rays
