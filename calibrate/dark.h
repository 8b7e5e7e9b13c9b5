// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/frame_stack.h"

#include <optional>
#include <span>
#include <vector>

namespace nearfield::calibrate {

/// One exposure of the darks.
struct DarkPoint {
    double exposure_us = 0;
    int frames = 0;
    double mean_dn = 0;
    double noise_dn = 0;  // of one value of one frame; 0: a single frame
};

/// Values without the lamp's light, pixel by pixel, at temperature_c and warmer:
///
///     dark(t) = black_dn + (room_dn_per_s + (dark_dn_per_s - room_dn_per_s) f(T)) t
///
/// f: rig::dark_growth. room_dn_per_s does not grow with the sensor's temperature.
struct DarkResult {
    std::vector<float> black_dn, dark_dn_per_s;
    std::vector<float> room_dn_per_s;  // 0 where the darks are all of one temperature
    std::vector<float> is_hot;         // 1: rate or noise beyond the limit
    /// Of one pixel that is not hot; their covariance, DN^2/s.
    double black_sigma_dn = 0, rate_sigma_dn_per_s = 0, covariance = 0;
    double median_rate_dn_per_s = 0, rate_limit_dn_per_s = 0;
    std::vector<DarkPoint> points;
    double temperature_c = 0;         // of the coolest frames; dark_dn_per_s is theirs
    double temperature_spread_c = 0;  // largest less smallest
    bool is_room_known = false;       // darks of two temperatures tell it
    bool has_temperature = false;
    double share_clipped = 0;  // of values that are 0: their black level is not to be seen
    int hot_pixels = 0;

    /// Sigma of dark(t) of one pixel.
    double sigma_dn(double exposure_s) const;
};

/// Straight line through every pixel's darks by least squares, each exposure weighed by its own
/// noise; with darks of two temperatures, at least 2 C apart, light of the room apart from dark
/// current. Hot: dark rate more than `limit_sigmas` robust sigmas above the median, or noise whose
/// chi-square is as improbable (Wilson and Hilferty 1931).
///
/// In      groups: frames with the lamp off, an entry for every exposure. What light is left in the
///         room is part of them, of dark_dn_per_s too, where the camera sees the screen, and it is
///         taken off again from frames of the lamp. Frames that do not see the screen (flats,
///         boards, filter views) lose that much too much: scale.h's stray light says how much.
/// Throws  Error without frames. One exposure alone: black_dn is its mean and the rate 0.
/// Memory  seven values a pixel, whatever the number of frames.
DarkResult dark_of(std::span<const ExposureGroup> groups,
                   const PixelLayout& layout,
                   const FrameReader& read,
                   double limit_sigmas);

}  // namespace nearfield::calibrate
