// SPDX-License-Identifier: Apache-2.0
/// One axis of the windowed sum: which texels of S a basis function sees, and with what moments.
/// Shared by the double reference (luminaire.cpp) and the float sum (prepared.cpp).
#pragma once

#include "formats/files/lightfield.h"
#include "formats/shared/window.glsl.h"

#undef SHARED_NAMESPACE
#define SHARED_NAMESPACE shared::f64
#include "formats/shared/window.glsl.h"
#undef SHARED_NAMESPACE
#define SHARED_NAMESPACE shared

#include <algorithm>
#include <cmath>

namespace nearfield::model {

/// A slab's geometry along x (axis 0) or y (axis 1), in the precision of the sum.
template <typename Real>
struct SlabAxis {
    Real delta, s_min, texel, pitch;
    int texels, grid;
    int cells;  // n of the profile

    SlabAxis(const Slab& slab, int axis)
        : delta(static_cast<Real>(slab.delta_m)),
          s_min(static_cast<Real>(slab.s_min_m[axis])),
          texel(static_cast<Real>(slab.texel_m()[axis])),
          pitch(static_cast<Real>(slab.pitch_m[axis])),
          texels(slab.texels[axis]),
          grid(slab.grid[axis]),
          cells(static_cast<int>(slab.profile.cells.size())) {}

    Real texel_edge(int i) const { return s_min + static_cast<Real>(i) * texel; }
};

/// A run of texels [first, first + count).
struct TexelRange {
    int first = 0, count = 0;
};

/// The texels that are in both; count 0 and first b.first where none are.
inline TexelRange intersection(TexelRange a, TexelRange b) {
    const int first = std::max(a.first, b.first);
    const int end = std::min(a.first + a.count, b.first + b.count);
    return end > first ? TexelRange{first, end - first} : TexelRange{b.first, 0};
}

/// The texels between two positions on S (in either order), clipped to S. A texel that is missed by
/// less than 1/64 of its width counts in, so that rounding cannot leave one out.
template <typename Real>
TexelRange texel_range(const SlabAxis<Real>& axis, Real s_a, Real s_b) {
    // Clamped before the conversion: just above U a window spans 1e7 times S.
    const auto index = [&](Real s, Real margin) {
        const Real i = std::floor((s - axis.s_min) / axis.texel + margin);
        return static_cast<int>(std::clamp(i, Real(-1), static_cast<Real>(axis.texels)));
    };
    const int first = std::max(index(std::min(s_a, s_b), Real(-0x1p-6)), 0);
    const int last = std::min(index(std::max(s_a, s_b), Real(0x1p-6)), axis.texels - 1);
    return {first, std::max(last - first + 1, 0)};
}

}  // namespace nearfield::model
