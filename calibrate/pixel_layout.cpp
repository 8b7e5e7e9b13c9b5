// SPDX-License-Identifier: Apache-2.0
#include "calibrate/pixel_layout.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <utility>

namespace nearfield::calibrate {

std::size_t PixelLayout::value_count() const {
    return static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y) *
           static_cast<std::size_t>(channels);
}

int PixelLayout::color(std::size_t value) const {
    if (channels == 3)
        return static_cast<int>(value % 3);
    const auto width = static_cast<std::size_t>(size_px.x);
    return color_of_site[value / width % 2 * 2 + value % width % 2];
}

std::size_t PixelLayout::value_at(int column, int row, int channel) const {
    return (static_cast<std::size_t>(row) * static_cast<std::size_t>(size_px.x) +
            static_cast<std::size_t>(column)) *
               static_cast<std::size_t>(channels) +
           static_cast<std::size_t>(channel);
}

PixelLayout layout_of(const capture::FrameRecord& frame) {
    PixelLayout layout;
    layout.size_px = frame.size_px;
    layout.channels = frame.channels;
    layout.bits = frame.bits;
    if (frame.channels == 3) {
        layout.mosaic = "rgb";
        return layout;
    }
    constexpr std::array<std::pair<const char*, const char*>, 4> kMosaics = {
        {{"RG", "rggb"}, {"GR", "grbg"}, {"GB", "gbrg"}, {"BG", "bggr"}}};
    const std::string prefix = "Bayer";
    if (frame.pixel_format.compare(0, prefix.size(), prefix) != 0)
        return layout;
    const std::string first = frame.pixel_format.substr(prefix.size(), 2);
    for (const auto& [begin, mosaic] : kMosaics) {
        if (first == begin)
            layout.mosaic = mosaic;
    }
    if (layout.mosaic == "mono")
        throw Error{"unknown colors", frame.file + ": pixel_format",
                    "BayerRG, BayerGR, BayerGB or BayerBG", frame.pixel_format};
    for (std::size_t site = 0; site < 4; ++site)
        layout.color_of_site[site] = static_cast<int>(std::string("rgb").find(layout.mosaic[site]));
    return layout;
}

void require_same(const PixelLayout& layout, const capture::FrameRecord& frame) {
    const auto text = [](glm::ivec2 size, int channels, int bits) {
        return fmt::format("{} x {} pixels, {} channels, {} bits", size.x, size.y, channels, bits);
    };
    if (frame.size_px != layout.size_px || frame.channels != layout.channels ||
        frame.bits != layout.bits)
        throw Error{"frames of different kinds in one capture", frame.file,
                    text(layout.size_px, layout.channels, layout.bits),
                    text(frame.size_px, frame.channels, frame.bits)};
}

}  // namespace nearfield::calibrate
