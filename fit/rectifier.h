// SPDX-License-Identifier: Apache-2.0
/// From a merged picture to illuminance of texels behind a filter of peak 1.
#pragma once

#include "fit/position_light.h"
#include "fit/rectify.h"
#include "formats/files/lightfield.h"

#include <vector>

namespace nearfield::fit {

/// Colors of the sensor's own pixels: 1 or 3.
int raw_colors(const rig::Radiometry& radiometry);

/// Weights of all texels, made once for all pictures of a measurement.
class Rectifier {
  public:
    /// In      planes: texels and their extent; channels: 1 (luminance) or 3
    Rectifier(const Measurement& measurement, const Slab& planes, int channels);

    /// A channel each: lux, [j][i]; variance infinite where nothing was seen.
    std::vector<RectifiedImage> rectified(const MergedImage& image) const;

    /// A texel's least width in cells of the sensor's lattice.
    double texel_cells_least() const { return maps_.front().texel_cells_least; }

  private:
    RectifiedImage mixed(const std::vector<RectifiedImage>& raw, int channel) const;

    const rig::Radiometry& radiometry_;
    int channels_;
    std::vector<float> lux_factors_;
    std::vector<RectifyMap> maps_;  // [raw color]
};

}  // namespace nearfield::fit
