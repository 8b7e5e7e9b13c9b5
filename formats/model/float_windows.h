// SPDX-License-Identifier: Apache-2.0
/// The windows of all basis functions along one axis, in float: what the float sum spends on
/// weights.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/axis_window.h"

#include <cstddef>
#include <vector>

namespace nearfield::model {

struct FloatWindow {
    TexelRange range;
    float t_lo = 0.0F, t_hi = 0.0F;  // tangents between which anything is seen
    std::size_t at = 0;              // offset of its weights in m0 and m1
};

struct FloatWindows {
    std::vector<FloatWindow> of_basis;
    /// Per texel of each window: int phi dt, int t phi dt; behind every window kRowPadding zeros.
    std::vector<float> m0, m1;
    float widest_texel_t = 0.0F;

    // Kept from call to call for their memory: a texel's ends in e, and the cells' edges.
    std::vector<float> texel_lo, texel_hi, cell_edge_e;
    std::vector<TexelRange> cell_range;
};

/// Fills the windows along x (axis 0) or y (1) for a receiver at p_m, height_m > -delta above S.
void fill(FloatWindows& windows, const Slab& slab, int axis, float p_m, float height_m);

}  // namespace nearfield::model
