// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/dark.h"
#include "formats/rig/rig.h"

#include <span>
#include <vector>

namespace nearfield::calibrate {

/// How well a width of the gaussian explains what dark pixels see.
struct VeilPoint {
    double sigma_px = 0;
    double share = 0;
    double chi2 = 0;
};

struct VeilResult {
    double share = 0, share_sigma = 0;
    double sigma_px = 0, sigma_sigma_px = 0;
    double chi2 = 0;  // at the best width, over all pixels used
    std::size_t pixels = 0;
    bool is_significant = false;  // share beyond 5 sigma: else 0 is to be used
    std::vector<VeilPoint> points;
};

/// Share and width of the lens' veil, from pictures of a board before a black backdrop: dark pixels
/// well off anything bright see the veil alone, P = v G * I + c. The constant c, one a picture,
/// takes what is even: errors of the black level, a backdrop that is not quite black, room light in
/// the darks. Widths are tried on a ladder; the best follows from the parabola through three of
/// them.
///
/// In      frames: target views; radiometry: gain, read noise, saturation
/// Out     not significant where no view shows enough dark pixels.
/// Cost    reads every view twice; 14 blurs a picture and round.
VeilResult veil_of_targets(std::span<const capture::FrameRecord* const> frames,
                           const PixelLayout& layout,
                           const DarkResult& dark,
                           const rig::Radiometry& radiometry,
                           const FrameReader& read);

}  // namespace nearfield::calibrate
