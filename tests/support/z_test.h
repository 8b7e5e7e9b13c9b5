// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace nearfield::support {

/// Chance that a normal variable lies outside 3 sigma: the significance of every family of z-tests
/// here.
constexpr double kThreeSigmaAlpha = 0.002699796063260;

/// The |z| that the largest of `count` independent standard normal variables exceeds with chance
/// `alpha` (Sidak). count = 1 and the default alpha give 3.
inline double sidak_z_limit(int count, double alpha = kThreeSigmaAlpha) {
    const double alpha_each = -std::expm1(std::log1p(-alpha) / count);
    double low = 0.0, high = 40.0;
    for (int step = 0; step < 100; ++step) {
        const double middle = 0.5 * (low + high);
        (std::erfc(middle / std::sqrt(2.0)) > alpha_each ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace nearfield::support
