// SPDX-License-Identifier: Apache-2.0
/// What frames themselves say about the camera and the lamp: settings that did not take, light that
/// changed. All signals are above black.
#pragma once

#include "formats/capture/frame.h"

#include <optional>
#include <span>

namespace nearfield::acquire {

/// Shares of the camera's range between which a pixel is well exposed: above the noise and
/// quantization of dark ones (a step of 12 bits is 0.5 % of the lowest), below where cameras bend
/// and light may flicker above.
constexpr double kWellExposedLow = 0.05, kWellExposedHigh = 0.80;

/// A frame and its black level in DN.
struct Signal {
    const capture::Frame* frame = nullptr;
    double black_dn = 0;
    double exposure_us = 0;
};

/// The true ratio of two exposures, from what both saw: sum of b over sum of a, over pixels that
/// are well exposed in b, whose exposure is the longer one. Choosing by b alone keeps the noise of
/// a from biasing it.
///
/// Returns nothing where fewer than 100 pixels tell, or a's mean there is below 2 % of the range:
/// an error of half a DN in black would show.
std::optional<double> exposure_ratio(const Signal& a, const Signal& b);

/// The share of pixels that are well exposed in at least two frames, among those that are brighter
/// than `darkest_share` of the brightest; 1 where none is.
double share_exposed_twice(std::span<const Signal> bracket, double darkest_share);

/// How many frames a camera is late: the index of the first frame after a change of exposure that
/// shows the new level, where `before_dn` is the old level and the last of `after_dn` the new one.
/// Nothing where the level never changed by more than `least_rel`: the camera ignores exposure.
std::optional<int> exposure_latency(double before_dn,
                                    std::span<const double> after_dn,
                                    double least_rel);

}  // namespace nearfield::acquire
