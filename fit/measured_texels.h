// SPDX-License-Identifier: Apache-2.0
/// All positions' rectified pictures, as rows of texels that are ready to be fitted.
#pragma once

#include "fit/blocked_light.h"
#include "fit/stream.h"
#include "fit/texel_spool.h"

#include <string>
#include <vector>

namespace nearfield::fit {

class MeasuredTexels {
  public:
    /// In      filter_overlap: what the filter's positions let through together, of a filter of
    ///         peak 1 (model::overlap squared); filter_peak: its transmission, by channel
    MeasuredTexels(const std::string& spool_folder,
                   glm::ivec2 texels,
                   int positions,
                   std::vector<BlockedLight> blocked,
                   double filter_overlap,
                   std::vector<double> filter_peak);

    /// A position's pictures, a channel each.
    void put(int position, const std::vector<RectifiedImage>& channels);

    /// Rows of texels, the light beside the filter taken off. What is held back at a position is
    /// what the plate holds back less what the position lets through.
    TileInput read(TileRange rows) const;

    /// Of the light that a plate holds back, what is still held back at a position.
    double held_back(int channel, int position) const;

    glm::ivec2 texels() const { return texels_; }
    int positions() const { return positions_; }
    int channels() const { return static_cast<int>(filter_peak_.size()); }

  private:
    glm::ivec2 texels_;
    int positions_;
    std::vector<BlockedLight> blocked_;
    double filter_overlap_;
    std::vector<double> filter_peak_;
    std::vector<double> light_;      // [channel * positions + position], mean over texels
    std::vector<double> light_sum_;  // [channel], of all positions
    TexelSpool spool_;
};

}  // namespace nearfield::fit
