// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/capture/records.h"

#include <glm/glm.hpp>

#include <array>
#include <cstddef>
#include <string>

namespace nearfield::calibrate {

/// How a frame's values stand: [row from the top][column][channel].
struct PixelLayout {
    glm::ivec2 size_px{0};
    int channels = 1;
    int bits = 16;
    std::string mosaic = "mono";                   // as rig::Radiometry::mosaic
    std::array<int, 4> color_of_site{0, 0, 0, 0};  // [y % 2][x % 2] of a mosaic

    std::size_t value_count() const;
    /// Colors: 1, or 3 of a mosaic and of "rgb".
    int colors() const { return mosaic == "mono" ? 1 : 3; }
    /// Color of a value: 0, or R 0, G 1, B 2.
    int color(std::size_t value) const;
    std::size_t value_at(int column, int row, int channel = 0) const;
    double range_dn() const { return static_cast<double>((1 << bits) - 1); }
};

/// From the frame's own words: "BayerRG12" is a mosaic "rggb", three channels are "rgb".
/// Throws Error on a pixel format whose colors are not known.
PixelLayout layout_of(const capture::FrameRecord& frame);

/// Throws Error naming the frame where its size, channels or bits are others than the layout's.
void require_same(const PixelLayout& layout, const capture::FrameRecord& frame);

}  // namespace nearfield::calibrate
