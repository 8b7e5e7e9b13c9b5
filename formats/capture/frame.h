// SPDX-License-Identifier: Apache-2.0
/// A camera's frame as it came: raw values, 16 bits each, and its form on disk.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nearfield::capture {

/// Raw values in digital numbers (DN): 0 ... 2^bits - 1, not scaled to 16 bits.
struct Frame {
    glm::ivec2 size_px{0};
    int channels = 1;                   // 1 (mono or Bayer mosaic) or 3
    int bits = 16;                      // of the camera: the range is 2^bits - 1
    std::vector<std::uint16_t> values;  // [row from the top][column][channel]

    int range_dn() const { return (1 << bits) - 1; }
};

/// What one look at a frame tells.
struct FrameLevels {
    int least_dn = 0, most_dn = 0;
    double mean_dn = 0;
    double share_saturated = 0;  // of the values, at the range's end
};

FrameLevels levels_of(const Frame& frame);

/// The frame as a 16-bit PNG, lossless: the values stand in it as they are.
/// Cost    512 x 512: a few ms.
std::string encode_frame(const Frame& frame);

/// The inverse of encode_frame, given the camera's bits. Throws Error naming `where` if it is no
/// PNG, is damaged, or holds values above the range.
Frame decode_frame(std::string_view png, int bits, const std::string& where);

}  // namespace nearfield::capture
