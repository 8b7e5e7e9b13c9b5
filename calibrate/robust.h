// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace nearfield::calibrate {

/// Middle value, of an even count the upper one; 0 of nothing. By copy.
float median_of(std::span<const float> values);

/// The value below which this share of all lies; 0 of nothing.
float quantile_of(std::span<const float> values, double share);

/// Standard deviation of normal values, from the median distance to their median: few that are far
/// off do not matter.
float robust_sigma_of(std::span<const float> values);

}  // namespace nearfield::calibrate
