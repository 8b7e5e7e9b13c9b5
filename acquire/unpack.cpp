// SPDX-License-Identifier: Apache-2.0
#include "acquire/unpack.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::acquire {
namespace {

unsigned at(std::span<const unsigned char> bytes, std::size_t k) {
    return bytes[k];
}

void unpack_8(std::span<const unsigned char> bytes, std::vector<std::uint16_t>& values) {
    std::copy_n(bytes.begin(), values.size(), values.begin());
}

// Mono10, Mono12, Mono16: two bytes a pixel, low byte first unless swapped.
void unpack_16(std::span<const unsigned char> bytes,
               bool is_swapped,
               std::vector<std::uint16_t>& values) {
    const std::size_t low = is_swapped ? 1 : 0;
    for (std::size_t k = 0; k < values.size(); ++k)
        values[k] =
            static_cast<std::uint16_t>(at(bytes, 2 * k + low) | at(bytes, 2 * k + 1 - low) << 8U);
}

// Mono12p: pixels follow each other bit by bit, lowest bits first.
void unpack_12p(std::span<const unsigned char> bytes, std::vector<std::uint16_t>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
        const std::size_t b = k / 2 * 3;
        const unsigned value = k % 2 == 0 ? at(bytes, b) | (at(bytes, b + 1) & 0xFU) << 8U
                                          : at(bytes, b + 1) >> 4U | at(bytes, b + 2) << 4U;
        values[k] = static_cast<std::uint16_t>(value);
    }
}

// Mono12Packed (GigE Vision): both pixels' high bytes outside, their low bits share the byte
// between.
void unpack_12_packed(std::span<const unsigned char> bytes, std::vector<std::uint16_t>& values) {
    for (std::size_t k = 0; k < values.size(); ++k) {
        const std::size_t b = k / 2 * 3;
        const unsigned value = k % 2 == 0 ? at(bytes, b) << 4U | (at(bytes, b + 1) & 0xFU)
                                          : at(bytes, b + 2) << 4U | at(bytes, b + 1) >> 4U;
        values[k] = static_cast<std::uint16_t>(value);
    }
}

std::vector<PixelFormat> known_formats() {
    std::vector<PixelFormat> formats = {{"Mono8", 8, 8},     {"Mono10", 10, 16},
                                        {"Mono12", 12, 16},  {"Mono12Packed", 12, 12},
                                        {"Mono12p", 12, 12}, {"Mono16", 16, 16}};
    for (const char* order : {"RG", "GR", "GB", "BG"}) {
        formats.push_back({fmt::format("Bayer{}8", order), 8, 8});
        formats.push_back({fmt::format("Bayer{}12", order), 12, 16});
    }
    return formats;
}

}  // namespace

const std::vector<PixelFormat>& pixel_formats() {
    static const std::vector<PixelFormat> formats = known_formats();
    return formats;
}

const PixelFormat& pixel_format_of(const std::string& name) {
    std::string known;
    for (const PixelFormat& format : pixel_formats()) {
        if (format.name == name)
            return format;
        known += (known.empty() ? "" : ", ") + format.name;
    }
    throw Error{"unknown pixel format", "camera", known, "'" + name + "'"};
}

std::size_t byte_count(const PixelFormat& format, glm::ivec2 size_px) {
    const std::size_t pixels =
        static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
    return (pixels * static_cast<std::size_t>(format.bits_in_memory) + 7) / 8;
}

capture::Frame unpack(const PixelFormat& format,
                      glm::ivec2 size_px,
                      std::span<const unsigned char> bytes,
                      bool is_byte_swapped) {
    const std::size_t expected = byte_count(format, size_px);
    if (size_px.x < 1 || size_px.y < 1 || bytes.size() < expected)
        throw Error{"incomplete frame",
                    fmt::format("{}, {} x {}", format.name, size_px.x, size_px.y),
                    fmt::format("{} bytes", expected), fmt::format("{}", bytes.size())};
    capture::Frame frame;
    frame.size_px = size_px;
    frame.bits = format.bits;
    frame.values.resize(static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y));
    if (format.bits_in_memory == 8)
        unpack_8(bytes, frame.values);
    else if (format.bits_in_memory == 16)
        unpack_16(bytes, is_byte_swapped, frame.values);
    else if (format.name == "Mono12p")
        unpack_12p(bytes, frame.values);
    else
        unpack_12_packed(bytes, frame.values);
    const std::uint16_t most = *std::max_element(frame.values.begin(), frame.values.end());
    if (most > frame.range_dn())
        throw Error{"bad frame", format.name, fmt::format("values up to {}", frame.range_dn()),
                    fmt::format("{}: is its byte order another (byte_swap)?", most)};
    return frame;
}

}  // namespace nearfield::acquire
