// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/pixel_format.h"

#include <algorithm>
#include <cassert>

namespace nearfield::gige {
namespace {

std::vector<std::uint8_t> pack_8(std::span<const std::uint16_t> values) {
    std::vector<std::uint8_t> bytes(values.size());
    std::transform(values.begin(), values.end(), bytes.begin(),
                   [](std::uint16_t value) { return static_cast<std::uint8_t>(value); });
    return bytes;
}

std::vector<std::uint8_t> pack_16(std::span<const std::uint16_t> values) {
    std::vector<std::uint8_t> bytes(2 * values.size());
    for (std::size_t k = 0; k < values.size(); ++k) {
        bytes[2 * k] = static_cast<std::uint8_t>(values[k]);
        bytes[2 * k + 1] = static_cast<std::uint8_t>(values[k] >> 8U);
    }
    return bytes;
}

// GigE Vision's own: the upper eight bits of both pixels, and between them a byte of both lower
// halves.
std::vector<std::uint8_t> pack_12_packed(std::span<const std::uint16_t> values) {
    std::vector<std::uint8_t> bytes((3 * values.size() + 1) / 2);
    for (std::size_t k = 0; k < values.size(); ++k) {
        const std::size_t triple = k / 2 * 3;
        const bool second = k % 2 == 1;
        const std::uint32_t low = values[k] & 0xFU;
        bytes[triple + (second ? 2 : 0)] = static_cast<std::uint8_t>(values[k] >> 4U);
        bytes[triple + 1] =
            static_cast<std::uint8_t>(bytes[triple + 1] | (second ? low << 4U : low));
    }
    return bytes;
}

// One stream of bits, the lowest first.
std::vector<std::uint8_t> pack_12p(std::span<const std::uint16_t> values) {
    std::vector<std::uint8_t> bytes((3 * values.size() + 1) / 2);
    for (std::size_t k = 0; k + 1 < values.size(); k += 2) {
        std::uint8_t* triple = bytes.data() + k / 2 * 3;
        triple[0] = static_cast<std::uint8_t>(values[k]);
        triple[1] = static_cast<std::uint8_t>(values[k] >> 8U | (values[k + 1] & 0xFU) << 4U);
        triple[2] = static_cast<std::uint8_t>(values[k + 1] >> 4U);
    }
    if (values.size() % 2 == 1) {
        bytes[bytes.size() - 2] = static_cast<std::uint8_t>(values.back());
        bytes[bytes.size() - 1] = static_cast<std::uint8_t>(values.back() >> 8U);
    }
    return bytes;
}

}  // namespace

std::optional<FormatInfo> format_info(std::uint32_t code) {
    const auto* found =
        std::find_if(kFormats.begin(), kFormats.end(), [code](const FormatInfo& known) {
            return static_cast<std::uint32_t>(known.format) == code;
        });
    return found == kFormats.end() ? std::nullopt : std::optional(*found);
}

std::size_t payload_bytes(PixelFormat format, glm::ivec2 size_px) {
    const std::size_t stored_bits = static_cast<std::uint32_t>(format) >> 16U & 0xFFU;
    return (static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y) *
                stored_bits +
            7) /
           8;
}

std::vector<std::uint8_t> pack(PixelFormat format, std::span<const std::uint16_t> values) {
    switch (format) {
        case PixelFormat::Mono8:
        case PixelFormat::BayerRG8:
            return pack_8(values);
        case PixelFormat::Mono12Packed:
            return pack_12_packed(values);
        case PixelFormat::Mono12p:
            return pack_12p(values);
        case PixelFormat::Mono10:
        case PixelFormat::Mono12:
        case PixelFormat::Mono16:
        case PixelFormat::BayerRG12:
            break;
    }
    return pack_16(values);
}

std::vector<std::uint16_t> crop(std::span<const std::uint16_t> values,
                                glm::ivec2 sensor_px,
                                glm::ivec2 offset_px,
                                glm::ivec2 size_px,
                                int sensor_bits,
                                int format_bits) {
    assert(offset_px.x + size_px.x <= sensor_px.x && offset_px.y + size_px.y <= sensor_px.y);
    const auto right = static_cast<std::uint32_t>(std::max(0, sensor_bits - format_bits));
    const auto left = static_cast<std::uint32_t>(std::max(0, format_bits - sensor_bits));
    std::vector<std::uint16_t> region(static_cast<std::size_t>(size_px.x) *
                                      static_cast<std::size_t>(size_px.y));
    auto to = region.begin();
    for (int y = 0; y < size_px.y; ++y) {
        const auto from =
            static_cast<std::size_t>(offset_px.y + y) * static_cast<std::size_t>(sensor_px.x) +
            static_cast<std::size_t>(offset_px.x);
        const auto row = values.subspan(from, static_cast<std::size_t>(size_px.x));
        to = std::transform(row.begin(), row.end(), to, [right, left](std::uint16_t value) {
            return static_cast<std::uint16_t>(value >> right << left);
        });
    }
    return region;
}

}  // namespace nearfield::gige
