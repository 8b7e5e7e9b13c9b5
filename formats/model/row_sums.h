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

/// Per channel c: sum over rows r and columns i of
/// images[c][r * stride + i] * (y0[r] * p[i] + y1[r] * q[i]).
/// An image may be read (finite values) up to kRowPadding beyond a row. channels: 1 ... 3; the
/// others' sums are 0. Cost: 2 multiply-adds a texel and channel; an image is read once, from cache
/// where neighboring receivers share windows.
std::array<float, 3> row_sums(const std::array<const float*, 3>& images,
                              int channels,
                              std::size_t stride,
                              const RowWeights& weights);

}  // namespace nearfield::model
