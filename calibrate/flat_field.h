// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/dark.h"
#include "formats/rig/rig.h"

#include <span>
#include <vector>

namespace nearfield::calibrate {

/// How far a camera is from linear at one exposure of the flats.
struct LinearityPoint {
    double exposure_us = 0;
    double signal_dn = 0;  // above dark, mean over the picture
    double rate_dn_per_s = 0;
    double deviation_rel = 0, sigma_rel = 0;  // of the rate from the mean rate; of counts and darks
    bool is_used = false;                     // neither saturated nor dark
};

/// Response of every pixel with the lens before it, to an even source.
///
/// What it cannot tell: how even the source itself is. A source that is brighter on one side
/// makes that side's light too weak by as much, and nothing here shows it; turning the source
/// by half between two series does.
struct FlatResult {
    std::vector<float> response;            // by color about a mean of 1
    std::vector<float> response_sigma_rel;  // counts and darks of this pixel
    std::vector<float> is_dead;             // 1: far from its neighbors of the same color
    std::vector<double> rate_dn_per_s;      // the source's mean rate, [color]
    std::vector<LinearityPoint> linearity;
    double linearity_rel = 0;    // largest deviation
    double linearity_sigma = 0;  // the same in sigmas of its own
    rig::Curve linear;           // DN to linear DN where deviations are significant; else empty
    int dead_pixels = 0;
    int frames = 0;
};

/// Mean over all usable exposures, less darks, weighed by counts. A pixel is dead where it differs
/// from the median of its neighbors by more than `dead_rel`.
///
/// In      radiometry: gain, read noise, saturation, veil; the veil is removed from the mean, so
///         that response is that of light without veil (formats/rig/veil.h).
/// Throws  Error where no exposure is usable: all saturated, or all too dark.
/// Memory  a stack and two sums a pixel.
FlatResult flat_field_of(std::span<const ExposureGroup> groups,
                         const PixelLayout& layout,
                         const DarkResult& dark,
                         const rig::Radiometry& radiometry,
                         const FrameReader& read,
                         double dead_rel);

/// Deviations of the exposures' rates from their mean, and a curve that straightens them where one
/// is beyond 5 sigma and 0.5 %.
void find_linearity(double black_dn, double range_dn, FlatResult& flat);

}  // namespace nearfield::calibrate
