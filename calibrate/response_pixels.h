// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibrate/response.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace nearfield::calibrate {

constexpr int kResponseLevels = 256;
constexpr int kWellDark = 10, kWellBright = 245;  // well exposed lies between
constexpr std::size_t kLeastExposures = 3;
// Training pixels of one curve: kTrainingSide^2, eight exposures of which outnumber its 256
// unknowns.
constexpr int kTrainingSide = 14;
constexpr std::size_t kCurves = 6;

/// Smooth pixels that are well exposed in three photographs or more in all channels, spread over
/// how bright they are: a set for each curve, and one that no curve sees.
struct ChosenPixels {
    std::array<std::vector<std::size_t>, kCurves> training;
    std::vector<std::size_t> held_out;
};

/// Throws Error where there are too few.
ChosenPixels choose_pixels(std::span<const Photograph> photographs,
                           int channels,
                           const std::vector<char>& is_used);

}  // namespace nearfield::calibrate
