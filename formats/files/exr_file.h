// SPDX-License-Identifier: Apache-2.0
/// The project's only contact with OpenEXR: arrays in memory as parts of an EXR file.
///
/// Sizes are checked against the file's size before anything is allocated, and only uncompressed,
/// RLE and ZIP data are read. All functions throw Error with file, part and place.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::exr {

/// One channel of an atlas: where pixel (0, 0) of image 0, the top left one, lies in an array, and
/// how far (in values) the next image, the pixel to the right and the pixel below are.
template <typename Value>
struct Plane {
    std::string channel;
    Value* data = nullptr;
    std::ptrdiff_t first = 0, image_stride = 0, column_stride = 1, row_stride = 0;
};

enum class Values {
    Any,
    Finite,
    NonNegative
};  // what a reader accepts; the last two refuse NaN and Inf

/// Images of one size, side by side in one part: image m = row * grid.x + column, row 0 at the
/// bottom.
template <typename Value>
struct Atlas {
    std::string part;
    glm::ivec2 grid{1}, image{0};
    std::vector<Plane<Value>> planes;
    Values values = Values::Any;
    bool is_tiled = true;  // each image a tile; else scanlines, and grid is 1 x 1
};

/// An array [m][j][i] whose rows rise with y, written upright.
template <typename Value>
Plane<Value> upright(std::string channel, Value* data, glm::ivec2 image) {
    const std::ptrdiff_t width = image.x, height = image.y;
    return {std::move(channel), data, (height - 1) * width, width * height, 1, -width};
}

enum class Compression { None, Zip };

using Attributes = std::vector<std::pair<std::string, std::string>>;

/// Writes the atlases as parts of one file, whole or not at all; the attributes go to the first.
void write(const std::vector<Atlas<const float>>& atlases,
           Compression compression,
           const Attributes& attributes,
           const std::string& path);

/// What a part's header says.
struct Part {
    std::string name;
    glm::ivec2 size{0}, tile{0};        // tile (0, 0): scanlines
    std::vector<std::string> channels;  // sorted by name
    int compression = 0;                // as OpenEXR numbers them
    int pixel_bytes = 0;                // of all channels, unpacked
};

/// An EXR file open for reading.
class Reader {
  public:
    explicit Reader(const std::string& path);
    ~Reader();
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    int part_count() const;
    Part part(int index) const;
    bool has_part(const std::string& name) const;

    /// A string attribute of the first part.
    std::optional<std::string> attribute(const std::string& name) const;

    /// Throws unless the part exists, is laid out like `shape` (whose arrays are not touched), and
    /// the file is large enough to hold it together with all that was required before. To call
    /// before allocating.
    void require(const Atlas<float>& shape);

    /// Reads a part that was required, on all threads.
    void read(const Atlas<float>& atlas) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace nearfield::exr
