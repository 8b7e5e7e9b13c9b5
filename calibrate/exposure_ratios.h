// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/dark.h"
#include "formats/rig/rig.h"

#include <span>
#include <vector>

namespace nearfield::calibrate {

/// How much longer one exposure is than the next shorter one, in truth.
struct ExposureRatio {
    double shorter_us = 0, longer_us = 0;  // asked for
    double ratio = 0, sigma_rel = 0;
    /// Scatter of positions beyond what counts explain, relative: the lamp's change between two
    /// frames. Part of sigma_rel.
    double drift_rel = 0;
    double chi2 = 0;  // of positions about their mean, counts alone
    int positions = 0;
    std::size_t pixels = 0;  // over all positions
};

struct RatioResult {
    std::vector<ExposureRatio> ratios;
    std::vector<rig::TrueExposure> exposures;  // ascending
    double reference_us = 0;                   // whose true time is as asked
};

/// Frames of one position, ascending in exposure: a bracket.
using Bracket = std::vector<const capture::FrameRecord*>;

/// True ratios of neighboring exposures by regression through the origin over pixels that are well
/// exposed in both, each position by itself; positions are combined with the scatter between them
/// as a second variance (DerSimonian and Laird 1986). The middle exposure is the reference.
///
/// A pixel is chosen and weighed by its light as both frames together tell it, whose error does not
/// go with that of the ratio: choosing by either frame alone would bias it.
///
/// In      brackets: every position's; dark, gain, read noise, saturation; linear
/// Out     an exposure without a usable neighbor keeps what was asked, with `unknown_sigma_rel`.
/// Cost    reads every frame of the brackets once; one float a pixel and pair.
RatioResult exposure_ratios_of(std::span<const Bracket> brackets,
                               const PixelLayout& layout,
                               const DarkResult& dark,
                               const rig::Radiometry& radiometry,
                               const rig::Maps& maps,
                               const FrameReader& read,
                               double unknown_sigma_rel);

}  // namespace nearfield::calibrate
