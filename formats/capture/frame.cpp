// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/frame.h"

#include "formats/files/error.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>

namespace nearfield::capture {
namespace {

constexpr png_uint_32 kMostPixels = 1U << 28U;  // beyond any sensor, within memory

std::size_t value_count(const Frame& frame) {
    return static_cast<std::size_t>(frame.size_px.x) * static_cast<std::size_t>(frame.size_px.y) *
           static_cast<std::size_t>(frame.channels);
}

}  // namespace

FrameLevels levels_of(const Frame& frame) {
    const auto [least, most] = std::minmax_element(frame.values.begin(), frame.values.end());
    if (least == frame.values.end())
        return {};
    std::uint64_t sum = 0, saturated = 0;
    const int range_dn = frame.range_dn();
    for (const std::uint16_t value : frame.values) {
        sum += value;
        saturated += value >= range_dn ? 1U : 0U;
    }
    const auto count = static_cast<double>(frame.values.size());
    return {*least, *most, static_cast<double>(sum) / count,
            static_cast<double>(saturated) / count};
}

std::string encode_frame(const Frame& frame) {
    if (frame.values.empty() || frame.values.size() != value_count(frame))
        throw Error{"bad frame", "values", fmt::format("{}", value_count(frame)),
                    fmt::format("{}", frame.values.size())};
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(frame.size_px.x);
    image.height = static_cast<png_uint_32>(frame.size_px.y);
    image.format = frame.channels == 1 ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_LINEAR_RGB;
    image.flags = PNG_IMAGE_FLAG_FAST;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string bytes(size, '\0');
    if (png_image_write_to_memory(&image, bytes.data(), &size, 0, frame.values.data(), 0,
                                  nullptr) == 0)
        throw Error{"cannot encode frame", "PNG", "", image.message};
    bytes.resize(size);
    return bytes;
}

Frame decode_frame(std::string_view png, int bits, const std::string& where) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_memory(&image, png.data(), png.size()) == 0)
        throw Error{"cannot read frame", where, "a PNG file", image.message};
    const bool is_linear = (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;
    if (!is_linear || image.width == 0 || image.height == 0 ||
        image.height > kMostPixels / image.width) {
        png_image_free(&image);
        throw Error{"cannot read frame", where, "16 bits, at most 2^28 pixels",
                    fmt::format("{} bits, {} x {}", is_linear ? 16 : 8, image.width, image.height)};
    }
    Frame frame;
    frame.bits = bits;
    frame.size_px = {static_cast<int>(image.width), static_cast<int>(image.height)};
    frame.channels = (image.format & PNG_FORMAT_FLAG_COLOR) != 0 ? 3 : 1;
    image.format = frame.channels == 1 ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_LINEAR_RGB;
    frame.values.resize(value_count(frame));
    if (png_image_finish_read(&image, nullptr, frame.values.data(), 0, nullptr) == 0)
        throw Error{"cannot read frame", where, "an undamaged PNG file", image.message};
    const auto most = std::max_element(frame.values.begin(), frame.values.end());
    if (*most > frame.range_dn())
        throw Error{"cannot read frame", where, fmt::format("values up to {}", frame.range_dn()),
                    fmt::format("{}", *most)};
    return frame;
}

}  // namespace nearfield::capture
