// SPDX-License-Identifier: Apache-2.0
#include "formats/model/row_sums.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "formats/model/row_sums.cpp"
#include <hwy/foreach_target.h>  // compiles this file once more for every target
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace nearfield::model::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Vec = hn::Vec<Floats>;

// Keeps a loaded vector in its register: g++ 12 folds the load into both multiply-adds that use it,
// and loads that cross cache lines are what limits this loop.
HWY_INLINE Vec keep_in_register(Vec v) {
#if HWY_COMPILER_GCC_ACTUAL && HWY_ARCH_X86
    asm("" : "+v"(v.raw));
#endif
    return v;
}

// One block of kVectors vectors of columns over all rows: R_i = sum_r c y0, T_i = sum_r c y1 stay
// in registers; then sum_i p_i R_i + q_i T_i. Narrow blocks take kUnroll rows at a time into
// accumulators of their own, to hide the latency of the multiply-adds.
template <int kVectors, int kUnroll>
HWY_INLINE Vec block_sums(const float* image,
                          std::size_t stride,
                          std::size_t rows,
                          const float* p,
                          const float* q,
                          const float* y0,
                          const float* y1) {
    const Floats d;
    const std::size_t lanes = hn::Lanes(d);
    constexpr int kSums = kVectors * kUnroll;
    Vec r[kSums], t[kSums];
#pragma GCC unroll 16
    for (int k = 0; k < kSums; ++k)
        r[k] = t[k] = hn::Zero(d);

    const auto add_row = [&](std::size_t row, int first) HWY_ATTR {
        const Vec w0 = hn::Set(d, y0[row]), w1 = hn::Set(d, y1[row]);
#pragma GCC unroll 16
        for (int v = 0; v < kVectors; ++v) {
            const Vec c = keep_in_register(
                hn::LoadU(d, image + row * stride + static_cast<std::size_t>(v) * lanes));
            r[first + v] = hn::MulAdd(c, w0, r[first + v]);
            t[first + v] = hn::MulAdd(c, w1, t[first + v]);
        }
    };
    std::size_t row = 0;
    for (; row + kUnroll <= rows; row += kUnroll) {
#pragma GCC unroll 16
        for (int u = 0; u < kUnroll; ++u)
            add_row(row + static_cast<std::size_t>(u), u * kVectors);
    }
    for (; row < rows; ++row)
        add_row(row, 0);

    Vec sum = hn::Zero(d);
#pragma GCC unroll 16
    for (int k = 0; k < kSums; ++k) {
        const std::size_t at = static_cast<std::size_t>(k % kVectors) * lanes;
        sum = hn::MulAdd(r[k], hn::LoadU(d, p + at), sum);
        sum = hn::MulAdd(t[k], hn::LoadU(d, q + at), sum);
    }
    return sum;
}

// Three channels of a window one vector wide: they share the weights' loads. Two rows at a time
// fill 12 accumulators.
std::array<float, 3> narrow_row_sums(const std::array<const float*, 3>& images,
                                     std::size_t stride,
                                     const RowWeights& weights) {
    const Floats d;
    constexpr int kChannels = 3, kUnroll = 2, kSums = kChannels * kUnroll;
    Vec r[kSums], t[kSums];
#pragma GCC unroll 16
    for (int k = 0; k < kSums; ++k)
        r[k] = t[k] = hn::Zero(d);
    const auto add_row = [&](std::size_t row, int first) HWY_ATTR {
        const Vec w0 = hn::Set(d, weights.y0[row]), w1 = hn::Set(d, weights.y1[row]);
#pragma GCC unroll 16
        for (int c = 0; c < kChannels; ++c) {
            const Vec texels =
                keep_in_register(hn::LoadU(d, images[static_cast<std::size_t>(c)] + row * stride));
            r[first + c] = hn::MulAdd(texels, w0, r[first + c]);
            t[first + c] = hn::MulAdd(texels, w1, t[first + c]);
        }
    };
    std::size_t row = 0;
    for (; row + kUnroll <= weights.rows; row += kUnroll) {
        add_row(row, 0);
        add_row(row + 1, kChannels);
    }
    if (row < weights.rows)
        add_row(row, 0);

    const Vec p = hn::LoadU(d, weights.p), q = hn::LoadU(d, weights.q);
    std::array<float, 3> sums{};
#pragma GCC unroll 16
    for (int c = 0; c < kChannels; ++c) {
        const Vec sum = hn::MulAdd(hn::Add(r[c], r[c + kChannels]), p,
                                   hn::Mul(hn::Add(t[c], t[c + kChannels]), q));
        sums[static_cast<std::size_t>(c)] = hn::GetLane(hn::SumOfLanes(d, sum));
    }
    return sums;
}

float row_sum(const float* image, std::size_t stride, const RowWeights& weights) {
    const auto& [rows, columns, p, q, y0, y1] = weights;
    const Floats d;
    const std::size_t lanes = hn::Lanes(d);
    constexpr std::size_t kWidest =
        4;  // 8 accumulators: what 4 cycles of latency at 2 a cycle need
    Vec sum = hn::Zero(d);
    std::size_t at = 0;
    for (; at + kWidest * lanes <= columns; at += kWidest * lanes)
        sum = hn::Add(sum, block_sums<4, 1>(image + at, stride, rows, p + at, q + at, y0, y1));
    if (at < columns) {
        switch ((columns - at + lanes - 1) / lanes) {
            case 1:
                sum = hn::Add(sum,
                              block_sums<1, 4>(image + at, stride, rows, p + at, q + at, y0, y1));
                break;
            case 2:
                sum = hn::Add(sum,
                              block_sums<2, 2>(image + at, stride, rows, p + at, q + at, y0, y1));
                break;
            case 3:
                sum = hn::Add(sum,
                              block_sums<3, 1>(image + at, stride, rows, p + at, q + at, y0, y1));
                break;
            default:
                sum = hn::Add(sum,
                              block_sums<4, 1>(image + at, stride, rows, p + at, q + at, y0, y1));
        }
    }
    return hn::GetLane(hn::SumOfLanes(d, sum));
}

}  // namespace nearfield::model::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nearfield::model {
HWY_EXPORT(row_sum);
HWY_EXPORT(narrow_row_sums);

float row_sum(const float* image, std::size_t stride, const RowWeights& weights) {
    return HWY_DYNAMIC_DISPATCH(row_sum)(image, stride, weights);
}

std::array<float, 3> narrow_row_sums(const std::array<const float*, 3>& images,
                                     std::size_t stride,
                                     const RowWeights& weights) {
    return HWY_DYNAMIC_DISPATCH(narrow_row_sums)(images, stride, weights);
}

}  // namespace nearfield::model
#endif
