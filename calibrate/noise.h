// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/frame_stack.h"

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::calibrate {

/// Mean and temporal variance of pixels of one level.
struct TransferPoint {
    double signal_dn = 0;  // above black
    double variance_dn2 = 0, sigma_dn2 = 0;
    std::size_t pairs = 0;  // of values that it comes from
    bool is_used = false;   // in the line
};

/// variance = read_noise^2 + signal / gain (Janesick 2007, "Photon Transfer").
struct NoiseResult {
    double gain_e_per_dn = 0, gain_sigma = 0;
    double read_noise_dn = 0, read_noise_sigma = 0;  // quantization included
    double chi2 = 0;
    int freedom = 0;
    double most_used_dn = 0;  // signal of the highest point of the line
    std::vector<TransferPoint> points;
};

/// Sums of differences of two frames of the same exposure and subject, sorted by signal: fixed
/// pattern and uneven light drop out. The pair's signal does not depend on its difference, so
/// sorting by it chooses nothing.
class TransferSums {
  public:
    TransferSums(const PixelLayout& layout,
                 std::span<const float> black_dn,
                 std::span<const float> is_bad);

    /// A slow change of the light between the two frames is taken out as one factor.
    void add(const capture::Frame& first, const capture::Frame& second);
    std::vector<TransferPoint> points() const;

  private:
    std::size_t bin_of(double signal_dn) const;

    std::span<const float> black_dn_, is_bad_;
    double bin_dn_ = 1, range_dn_ = 0;
    std::vector<double> signal_, squares_;
    std::vector<std::size_t> count_;
};

/// How often each value occurs in frames that may be too bright.
struct LevelHistogram {
    std::vector<std::uint64_t> counts;

    void add(const capture::Frame& frame);
};

/// Where values end. Of a camera whose wells are full before its range is, values pile up about a
/// level below the range's end.
struct Saturation {
    double clip_dn = 0;        // the range's end or the full well's level
    double saturation_dn = 0;  // values from here on are not to be used: 3 sigma of noise below
    bool is_reached = false;   // seen; else the range's end is assumed
    bool is_full_well = false;
};

/// The line through points up to `most_share` of the highest signal before variance collapses
/// (below half of what the line says) or `clip_signal_dn`. Iteratively reweighted: a variance of n
/// pairs has sigma variance * sqrt(2 / n).
/// Throws  Error where there are fewer than two levels: flats are missing, all dark or saturated.
NoiseResult noise_of(std::vector<TransferPoint> points, double clip_signal_dn);

Saturation saturation_of(const LevelHistogram& histogram,
                         const PixelLayout& layout,
                         double black_dn,
                         double gain_e_per_dn,
                         double read_noise_dn);

}  // namespace nearfield::calibrate
