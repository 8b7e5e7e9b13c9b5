// SPDX-License-Identifier: Apache-2.0
#include "fit/measured_texels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::fit {
namespace {

double mean_of_known(const RectifiedImage& image) {
    double sum = 0, count = 0;
    for (std::size_t t = 0; t < image.value.size(); ++t)
        if (std::isfinite(image.variance[t])) {
            sum += double(image.value[t]);
            count += 1.0;
        }
    return count > 0.0 ? std::max(0.0, sum / count) : 0.0;
}

}  // namespace

MeasuredTexels::MeasuredTexels(const std::string& spool_folder,
                               glm::ivec2 texels,
                               int positions,
                               std::vector<BlockedLight> blocked,
                               double filter_overlap,
                               std::vector<double> filter_peak)
    : texels_(texels),
      positions_(positions),
      blocked_(std::move(blocked)),
      filter_overlap_(filter_overlap),
      filter_peak_(std::move(filter_peak)),
      light_(filter_peak_.size() * static_cast<std::size_t>(positions), 0.0),
      light_sum_(filter_peak_.size(), 0.0),
      spool_(spool_folder, texels, static_cast<int>(filter_peak_.size()), positions) {}

void MeasuredTexels::put(int position, const std::vector<RectifiedImage>& channels) {
    for (std::size_t channel = 0; channel < channels.size(); ++channel) {
        const double mean = mean_of_known(channels[channel]);
        light_[channel * static_cast<std::size_t>(positions_) +
               static_cast<std::size_t>(position)] = mean;
        light_sum_[channel] += mean;
        spool_.put(position, static_cast<int>(channel), channels[channel]);
    }
}

double MeasuredTexels::held_back(int channel, int position) const {
    const auto c = static_cast<std::size_t>(channel);
    const double open = light_sum_[c] / filter_overlap_;
    if (!(open > 0.0))
        return 1.0;
    const double through =
        filter_peak_[c] *
        light_[c * static_cast<std::size_t>(positions_) + static_cast<std::size_t>(position)];
    return std::clamp(1.0 - through / open, 0.0, 1.0);
}

TileInput MeasuredTexels::read(TileRange rows) const {
    TileInput tile = spool_.read(rows);
    const auto width = static_cast<std::size_t>(texels_.x);
    const std::size_t count = static_cast<std::size_t>(rows.row_count) * width;
    const std::size_t first = static_cast<std::size_t>(rows.first_row) * width;
    const auto positions = static_cast<std::size_t>(positions_);
    for (std::size_t channel = 0; channel < blocked_.size(); ++channel)
        for (std::size_t k = 0; k < positions; ++k) {
            const auto held =
                static_cast<float>(held_back(static_cast<int>(channel), static_cast<int>(k)));
            for (std::size_t t = 0; t < count; ++t)
                tile.value[(channel * positions + k) * count + t] -=
                    held * blocked_[channel].lux[first + t];
        }
    return tile;
}

}  // namespace nearfield::fit
