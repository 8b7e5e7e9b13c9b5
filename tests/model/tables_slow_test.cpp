// SPDX-License-Identifier: Apache-2.0
// The largest summed-area tables: 4096^2 texels, 280 MB.
#include "tests/model/texel_sums.h"

#include <gtest/gtest.h>

namespace nearfield::test {
namespace {

// Proves what SummedAreaTable.HoldsDarkBoxesOfABrightImage proves, at the largest size that the
// format's promise is for.
TEST(SummedAreaTableSlow, HoldsDarkBoxesOfABrightImageOf4096) {
    expect_precise_boxes(4096, 60);
}

}  // namespace
}  // namespace nearfield::test
