// SPDX-License-Identifier: Apache-2.0
/// The multiply-adds of the float sum, vectorized by Highway and dispatched at run time.
#pragma once

#include <array>
#include <cstddef>

namespace nearfield::model {

/// Lanes that a row may be read beyond its end: the widest vector, 16 floats.
constexpr std::size_t kRowPadding = 16;

/// What the channels of one window have in common. p and q hold `columns` weights and kRowPadding
/// zeros behind them.
struct RowWeights {
    std::size_t rows, columns;
    const float *p, *q, *y0, *y1;
};

/// sum over rows r and columns i of image[r * stride + i] * (y0[r] * p[i] + y1[r] * q[i]).
/// The image may be read (finite values) up to kRowPadding beyond a row.
/// Cost: 2 multiply-adds a texel; an image is read once, from cache where
/// neighboring receivers share windows.
float row_sum(const float* image, std::size_t stride, const RowWeights& weights);

/// Windows as wide as the narrowest vector that is dispatched to.
constexpr std::size_t kNarrowColumns = 8;

/// The same for the three channels of a window of at most kNarrowColumns, which share the weights'
/// loads.
std::array<float, 3> narrow_row_sums(const std::array<const float*, 3>& images,
                                     std::size_t stride,
                                     const RowWeights& weights);

}  // namespace nearfield::model
