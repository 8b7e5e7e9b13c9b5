// SPDX-License-Identifier: Apache-2.0
/// Pixel formats of the network camera, and how values become their bytes.
///
/// Source: GenICam Pixel Format Naming Convention 2.1 (codes, Mono12p); GigE Vision 1.2
/// (Mono12Packed).
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace nearfield::gige {

/// The code that the wire has; its third byte is the number of bits that a pixel takes there.
enum class PixelFormat : std::uint32_t {
    Mono8 = 0x01080001,
    Mono10 = 0x01100003,
    Mono12 = 0x01100005,
    Mono12Packed = 0x010C0006,
    Mono12p = 0x010C0047,
    Mono16 = 0x01100007,
    BayerRG8 = 0x01080009,
    BayerRG12 = 0x01100011,
};

struct FormatInfo {
    PixelFormat format;
    const char* name;
    int value_bits;  // values are 0 ... 2^value_bits - 1
    bool is_bayer;   // RGGB: red at the sensor's (0, 0)
};

inline constexpr std::array<FormatInfo, 8> kFormats = {{
    {PixelFormat::Mono8, "Mono8", 8, false},
    {PixelFormat::Mono10, "Mono10", 10, false},
    {PixelFormat::Mono12, "Mono12", 12, false},
    {PixelFormat::Mono12Packed, "Mono12Packed", 12, false},
    {PixelFormat::Mono12p, "Mono12p", 12, false},
    {PixelFormat::Mono16, "Mono16", 16, false},
    {PixelFormat::BayerRG8, "BayerRG8", 8, true},
    {PixelFormat::BayerRG12, "BayerRG12", 12, true},
}};

/// What is known of a format; nothing where the code is none of ours.
std::optional<FormatInfo> format_info(std::uint32_t code);

/// Bytes of a picture: lines follow each other without padding, the last byte is filled up.
std::size_t payload_bytes(PixelFormat format, glm::ivec2 size_px);

/// The bytes of values that fit the format. 8 bits a byte; 10, 12 and 16 bits in two bytes, low
/// byte first; Mono12Packed and Mono12p as two pixels in three bytes.
std::vector<std::uint8_t> pack(PixelFormat format, std::span<const std::uint16_t> values);

/// Cuts a region out of a sensor's picture and shifts its values from the sensor's bits to the
/// format's: fewer bits drop the lowest, more bits append zeros.
///
/// values  rows from the top, sensor_px.x * sensor_px.y
std::vector<std::uint16_t> crop(std::span<const std::uint16_t> values,
                                glm::ivec2 sensor_px,
                                glm::ivec2 offset_px,
                                glm::ivec2 size_px,
                                int sensor_bits,
                                int format_bits);

}  // namespace nearfield::gige
