// SPDX-License-Identifier: Apache-2.0
/// The multiply-adds of the float sum, vectorized by Highway and dispatched at run time.
#pragma once

#include <cstddef>

namespace nearfield::model {

/// Lanes that a row may be read beyond its end: the widest vector, 16 floats.
constexpr std::size_t kRowPadding = 16;

/// sum over rows r and columns i of image[r * stride + i] * (y0[r] * p[i] + y1[r] * q[i]).
/// p and q hold `columns` weights and kRowPadding zeros behind them; image may be read (finite
/// values) as far. Cost: 2 multiply-adds a texel; the image is read once, from cache where
/// neighboring receivers share windows.
float row_sums(const float* image,
               std::size_t stride,
               std::size_t rows,
               std::size_t columns,
               const float* p,
               const float* q,
               const float* y0,
               const float* y1);

}  // namespace nearfield::model
