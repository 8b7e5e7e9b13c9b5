// SPDX-License-Identifier: Apache-2.0
/// Light that reaches the screen beside the filter: what the plate that carries it holds back and
/// walls and rims send on. It is measured with an opaque plate instead of the filter.
#pragma once

#include "fit/rectifier.h"

#include <vector>

namespace nearfield::fit {

/// Of one channel. Such light forms no picture: a parabola over S holds it, and its noise is gone.
struct BlockedLight {
    std::vector<float> lux;  // of every texel, [j][i], as through a filter of peak 1
    double mean_lx = 0;
    double sigma_lx = 0;    // of the mean; all texels and positions share it
    double chi_square = 0;  // of texels against the parabola, by degree of freedom
};

/// By channel; empty where the capture has no such frames.
/// Throws Error if none of their texels can be used.
std::vector<BlockedLight> blocked_light(const Measurement& measurement,
                                        const LampDrift& drift,
                                        const Rectifier& rectifier,
                                        glm::ivec2 texels);

/// The parabola of a picture in x and y, weighed by variance; infinite: left out. Texels that lie
/// off it, as beside the screen, lose their weight.
/// Throws Error if fewer than six texels are known.
BlockedLight smooth_light(const RectifiedImage& image, glm::ivec2 texels);

}  // namespace nearfield::fit
