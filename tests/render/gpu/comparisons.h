// SPDX-License-Identifier: Apache-2.0
/// How pictures of the two devices are compared.
#pragma once

#include "formats/files/image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::test {

/// Share of values above 1e-3 of the largest that agree within a relative error; 1 where there are
/// none. lit: how many those are at least.
inline double share_within(const Layer& a,
                           const Layer& reference,
                           double relative,
                           std::size_t lit_at_least = 1000) {
    const float largest = *std::max_element(reference.values.begin(), reference.values.end());
    std::size_t lit = 0, within = 0;
    for (std::size_t k = 0; k < reference.values.size(); ++k) {
        if (!(reference.values[k] > 1e-3F * largest))
            continue;
        ++lit;
        const double error = std::abs(
            static_cast<double>(a.values[k]) / static_cast<double>(reference.values[k]) - 1.0);
        within += error <= relative ? 1U : 0U;
    }
    EXPECT_GE(lit, lit_at_least);
    return lit == 0 ? 1.0 : static_cast<double>(within) / static_cast<double>(lit);
}

/// Numbers in all layers, and no negative ones but in normals.
inline void expect_light(const Picture& picture) {
    for (const Layer& each : picture.layers)
        EXPECT_TRUE(std::all_of(each.values.begin(), each.values.end(), [&](float value) {
            return std::isfinite(value) && (value >= 0.0F || each.name == "normal");
        })) << each.name;
}

}  // namespace nearfield::test
