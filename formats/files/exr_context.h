// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/exr_file.h"

#include <OpenEXR/openexr.h>

#include <algorithm>
#include <mutex>
#include <string>

namespace nearfield::exr {

/// Largest data window and tile that are read or written, in pixels along an edge.
constexpr int kMaxImage_px = 1 << 20;
constexpr int kMaxTile_px = 1 << 16;

/// OpenEXR's last message, kept instead of printed.
class Messages {
  public:
    void keep(const char* text) {
        const std::lock_guard lock(mutex_);
        if (text_.empty())
            text_ = text;
    }
    std::string take(exr_result_t result) {
        const std::lock_guard lock(mutex_);
        std::string text = text_.empty() ? exr_get_default_error_message(result) : text_;
        text_.clear();
        return text;
    }

  private:
    std::mutex mutex_;
    std::string text_;
};

/// One run of pixels that EXR stores together: a tile, or a few scanlines.
struct Chunk {
    int tile_x = 0, tile_y = 0;  // of a tile, from the top left
    int row = 0;                 // first row from the top within its image
};

/// The chunks of an atlas in file order; rows_per_chunk counts for scanlines.
template <typename Value>
std::size_t chunk_count(const Atlas<Value>& atlas, int rows_per_chunk) {
    if (atlas.is_tiled)
        return static_cast<std::size_t>(atlas.grid.x) * static_cast<std::size_t>(atlas.grid.y);
    return static_cast<std::size_t>((atlas.image.y + rows_per_chunk - 1) / rows_per_chunk);
}

template <typename Value>
Chunk chunk_at(const Atlas<Value>& atlas, std::size_t index, int rows_per_chunk) {
    const int k = static_cast<int>(index);
    if (atlas.is_tiled)
        return {k % atlas.grid.x, k / atlas.grid.x, 0};
    return {0, 0, k * rows_per_chunk};
}

/// Image m of a chunk: EXR's tile rows count from the top, ours from the bottom.
template <typename Value>
int image_at(const Atlas<Value>& atlas, const Chunk& chunk) {
    return (atlas.grid.y - 1 - chunk.tile_y) * atlas.grid.x + chunk.tile_x;
}

/// A chunk's first pixel in a plane.
template <typename Value>
Value* origin(const Atlas<Value>& atlas, const Plane<Value>& plane, const Chunk& chunk) {
    return plane.data + plane.first + image_at(atlas, chunk) * plane.image_stride +
           chunk.row * plane.row_stride;
}

/// Fills what both pipelines need to know of a float channel.
template <typename Value>
void set_strides(exr_coding_channel_info_t& channel, const Plane<Value>& plane) {
    constexpr int kBytes = sizeof(float);
    channel.user_bytes_per_element = kBytes;
    channel.user_data_type = EXR_PIXEL_FLOAT;
    channel.user_pixel_stride = static_cast<int32_t>(plane.column_stride * kBytes);
    channel.user_line_stride = static_cast<int32_t>(plane.row_stride * kBytes);
}

}  // namespace nearfield::exr
