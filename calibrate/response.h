// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/rig/rig.h"

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::calibrate {

/// A photograph of a bracket: 8 bits, [row][column][channel], R, G, B or one channel.
struct Photograph {
    std::vector<std::uint8_t> values;
    int width_px = 0;
    double exposure_s = 0;  // relative ones do
};

/// How 8-bit values follow light.
struct ResponseCurve {
    std::vector<rig::Curve> linear;  // [channel]: value to linear value, equal at 128; monotone
    /// Sigma of a linear value, relative, [channel][value]: scatter of pixels that were held out,
    /// between two exposures. 0 where none was seen.
    std::vector<std::array<double, 256>> sigma_rel;
    int pixels = 0, held_out = 0;
};

/// Recovers the response of unknown photographs from a bracket, by Debevec and Malik, "Recovering
/// High Dynamic Range Radiance Maps from Photographs", 1997 (OpenCV's CalibrateDebevec): six
/// times from pixels of their own, whose logarithms are averaged, then made monotone by pooling
/// neighbors. Pixels are taken where the picture is smooth: photographs of a bracket never lie on
/// each other to the pixel.
///
/// In      is_used: of every pixel; empty: all
/// Throws  Error for fewer than 3 exposures, photographs of different sizes, or where too few
///         pixels are well exposed in three of them.
ResponseCurve recover_response(std::span<const Photograph> photographs,
                               int channels,
                               const std::vector<char>& is_used);

/// Light of one pixel and channel, relative: mean of the exposures' logarithms, weighed by how well
/// each is exposed (a tent over the range). 0 where no exposure is.
std::vector<float> merged(std::span<const Photograph> photographs,
                          int channels,
                          const ResponseCurve& response);

}  // namespace nearfield::calibrate
