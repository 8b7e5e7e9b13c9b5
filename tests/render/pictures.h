// SPDX-License-Identifier: Apache-2.0
/// Options of small pictures, and how pictures are compared.
#pragma once

#include "render/options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::test {

inline render::RenderOptions small(int side_px = 16) {
    render::RenderOptions options;
    options.size_px = {side_px, side_px};
    return options;
}

/// Largest difference of two layers relative to the first one's largest value.
inline double difference(const Layer& a, const Layer& b) {
    double largest = 0.0, worst = 0.0;
    EXPECT_EQ(a.values.size(), b.values.size());
    for (std::size_t i = 0; i < std::min(a.values.size(), b.values.size()); ++i) {
        largest = std::max(largest, static_cast<double>(a.values[i]));
        worst = std::max(worst, static_cast<double>(std::abs(a.values[i] - b.values[i])));
    }
    EXPECT_GT(largest, 0.0);
    return worst / largest;
}

}  // namespace nearfield::test
