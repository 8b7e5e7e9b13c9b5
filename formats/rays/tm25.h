// SPDX-License-Identifier: Apache-2.0
/// The header of IES TM-25 ray files. Source: IES TM-25-13, "Ray file format for the description of
/// the emission property of light sources", section 4.7. Lengths in the file are mm; everything is
/// little-endian.
#pragma once

#include "formats/rays/byte_reader.h"
#include "formats/rays/ray_layout.h"

namespace nearfield::rays {

constexpr std::int32_t kTm25Version = 2013;
constexpr std::uint64_t kTm25FlagsByte = 256;     // section 4.7.2
constexpr std::uint64_t kTm25TablesByte = 36288;  // after nine text fields of 4000 bytes, 4.7.3

/// Whether the file starts as a TM-25 file does. Leaves the reader where it was.
bool is_tm25(ByteReader& file);

/// Reads the header. Throws Error naming byte offset (and ray) where the file is truncated, has
/// another version, contradicts itself, or promises rays that its size does not justify.
RayLayout read_tm25_header(ByteReader& file);

}  // namespace nearfield::rays
