// SPDX-License-Identifier: Apache-2.0
#include "fit/texel_spool.h"

#include <limits>

namespace nearfield::fit {

TexelSpool::TexelSpool(const std::string& folder, glm::ivec2 texels, int channels, int positions)
    : texels_(texels),
      positions_(positions),
      is_put_(static_cast<std::size_t>(channels) * static_cast<std::size_t>(positions), false),
      file_(std::make_unique<UnnamedFile>(folder)) {}

std::size_t TexelSpool::texel_count() const {
    return static_cast<std::size_t>(texels_.x) * static_cast<std::size_t>(texels_.y);
}

std::uint64_t TexelSpool::offset(int position, int channel, bool is_variance, int row) const {
    const auto image =
        2 * (static_cast<std::uint64_t>(channel) * static_cast<std::uint64_t>(positions_) +
             static_cast<std::uint64_t>(position)) +
        (is_variance ? 1 : 0);
    return sizeof(float) * (image * texel_count() + static_cast<std::uint64_t>(row) *
                                                        static_cast<std::uint64_t>(texels_.x));
}

void TexelSpool::put(int position, int channel, const RectifiedImage& image) {
    for (const bool is_variance : {false, true}) {
        const std::vector<float>& values = is_variance ? image.variance : image.value;
        file_->write_at(values.data(), values.size() * sizeof(float),
                        offset(position, channel, is_variance, 0));
    }
    is_put_[static_cast<std::size_t>(channel) * static_cast<std::size_t>(positions_) +
            static_cast<std::size_t>(position)] = true;
}

TileInput TexelSpool::read(TileRange rows) const {
    const std::size_t count =
        static_cast<std::size_t>(rows.row_count) * static_cast<std::size_t>(texels_.x);
    TileInput tile;
    tile.value.assign(is_put_.size() * count, 0.0F);
    tile.variance.assign(is_put_.size() * count, std::numeric_limits<float>::infinity());
    for (std::size_t image = 0; image < is_put_.size(); ++image) {
        if (!is_put_[image])
            continue;
        const int channel = static_cast<int>(image) / positions_;
        const int position = static_cast<int>(image) % positions_;
        for (const bool is_variance : {false, true}) {
            float* values = (is_variance ? tile.variance : tile.value).data() + image * count;
            file_->read_at(values, count * sizeof(float),
                           offset(position, channel, is_variance, rows.first_row));
        }
    }
    return tile;
}

}  // namespace nearfield::fit
