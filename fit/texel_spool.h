// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/rectify.h"
#include "fit/stream.h"
#include "formats/files/unnamed_file.h"

#include <memory>
#include <string>
#include <vector>

namespace nearfield::fit {

/// Rectified pictures of all positions, kept in a file without a name: written position by
/// position, read as rows of texels. What it takes of memory is what is being written or read.
class TexelSpool {
  public:
    /// Throws Error naming the folder if it cannot be written.
    TexelSpool(const std::string& folder, glm::ivec2 texels, int channels, int positions);

    /// Throws Error where the disk is full.
    void put(int position, int channel, const RectifiedImage& image);
    /// Positions that were never put are missing: variance infinite.
    TileInput read(TileRange rows) const;

  private:
    std::size_t texel_count() const;
    std::uint64_t offset(int position, int channel, bool is_variance, int row) const;

    glm::ivec2 texels_;
    int positions_;
    std::vector<bool> is_put_;  // [channel * positions + position]
    std::unique_ptr<UnnamedFile> file_;
};

}  // namespace nearfield::fit
