// SPDX-License-Identifier: Apache-2.0
/// Writing EXR files that are larger than memory.
#pragma once

#include "formats/files/exr_file.h"

#include <functional>

namespace nearfield::exr {

/// Puts one image of an atlas' plane into `values`, [row from the bottom][column].
using FetchImage =
    std::function<void(std::size_t atlas, std::size_t plane, int image, float* values)>;

/// The same file as write() makes of tiled atlases, whose planes here have no data: images are
/// fetched as they are written, from the calling thread.
/// Memory  a few images with all their planes: one where they have 64 MiB or more.
void write_fetched(const std::vector<Atlas<const float>>& atlases,
                   const FetchImage& fetch,
                   Compression compression,
                   const Attributes& attributes,
                   const std::string& path);

}  // namespace nearfield::exr
