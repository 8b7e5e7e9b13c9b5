// SPDX-License-Identifier: Apache-2.0
/// Pixel formats of cameras (GenICam's PFNC), unpacked by us: drivers hand over bytes.
#pragma once

#include "formats/capture/frame.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace nearfield::acquire {

/// A pixel format by its PFNC name.
struct PixelFormat {
    std::string name;
    int bits = 8;            // that a pixel holds
    int bits_in_memory = 8;  // that a pixel takes
};

/// All formats that unpack() knows: Mono8, 10, 12, 12Packed, 12p, 16, BayerRG8, BayerRG12 and the
/// other three Bayer orders of both.
const std::vector<PixelFormat>& pixel_formats();

/// The format of a name. Throws Error that lists those known.
const PixelFormat& pixel_format_of(const std::string& name);

/// Bytes of a frame, rows one after another without padding: packed pixels run on across row ends.
std::size_t byte_count(const PixelFormat& format, glm::ivec2 size_px);

/// The values of a frame. `is_byte_swapped`: 16-bit pixels come with the high byte first.
/// Throws Error where there are fewer bytes than the size asks for, or a value is above the range.
capture::Frame unpack(const PixelFormat& format,
                      glm::ivec2 size_px,
                      std::span<const unsigned char> bytes,
                      bool is_byte_swapped);

}  // namespace nearfield::acquire
