// SPDX-License-Identifier: Apache-2.0
/// What frames themselves say about the camera and the lamp: settings that did not take, light that
/// changed. All signals are above black.
#pragma once

#include "formats/capture/frame.h"

#include <array>
#include <cstddef>
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

/// Pixels of brackets, counted by brightness: quarters of an octave of DN / us.
struct ExposureTally {
    static constexpr int kBins = 240;
    std::array<std::size_t, kBins> pixels{};  // all
    std::array<std::size_t, kBins> twice{};   // well exposed in at least two frames
};

/// Adds a bracket's pixels. A pixel's brightness is its signal in all exposures that do not exceed
/// the well exposed part of the range, over their time.
void tally(std::span<const Signal> bracket, ExposureTally& counts);

/// The share of pixels that are well exposed at least twice, among those not darker than
/// `darkest_share` of the brightest (of which one in ten thousand is left out: hot pixels); 1 where
/// there is none.
double share_exposed_twice(const ExposureTally& counts, double darkest_share);

/// How many frames a camera is late: the index of the first frame after a change of exposure that
/// shows the new level, where `before_dn` is the old level and the last of `after_dn` the new one.
/// Nothing where the level never changed by more than `least_rel`: the camera ignores exposure.
std::optional<int> exposure_latency(double before_dn,
                                    std::span<const double> after_dn,
                                    double least_rel);

}  // namespace nearfield::acquire
