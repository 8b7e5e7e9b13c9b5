// SPDX-License-Identifier: Apache-2.0
#include "fit/normal.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace nearfield::fit {
namespace {

constexpr int kVector = 4;
using Four = Eigen::Array<double, kVector, 1>;

Eigen::Map<Four> four(double* p) {
    return Eigen::Map<Four>(p);
}

Eigen::Map<const Four> four(const double* p) {
    return Eigen::Map<const Four>(p);
}

// A tile of N: sums that fit the registers.
constexpr int kTileColumns = 4;
constexpr int kTileRows = 2 * kVector;

struct TileColumn {
    Four low = Four::Zero(), high = Four::Zero();

    void add(const TileColumn& right, double factor) {
        low += right.low * factor;
        high += right.high * factor;
    }
    void add_to(double* to) const {
        four(to) += low;
        four(to + kVector) += high;
    }
};

// Measurements whose rectangles begin at the same column, and cover two rows of the grid.
struct RowPairs {
    std::span<const std::ptrdiff_t> origin;  // of each: where row 0 of the grid would be
    const double* weighted;                  // G with weights, at the left row and first column
    const double* right;                     // G at the right row and first row of N
};

// Adds the sum over measurements of left right^T to the first `count` columns of a tile. Four
// variables, not an array: an array stays in memory.
void add_tile(const RowPairs& pairs, double* to, std::ptrdiff_t leading, int count) {
    TileColumn sum0, sum1, sum2, sum3;
    for (const std::ptrdiff_t origin : pairs.origin) {
        const double* r = pairs.right + origin;
        const TileColumn right{four(r), four(r + kVector)};
        const double* left = pairs.weighted + origin;
        sum0.add(right, left[0]);
        sum1.add(right, left[1]);
        sum2.add(right, left[2]);
        sum3.add(right, left[3]);
    }
    sum0.add_to(to);
    if (count > 1)
        sum1.add_to(to + leading);
    if (count > 2)
        sum2.add_to(to + 2 * leading);
    if (count > 3)
        sum3.add_to(to + 3 * leading);
}

// Part of N between rows `row` and `other` >= row of the basis grid. What a tile adds past a
// rectangle's last column is 0.
void add_rows(const TexelDesign& texel,
              const std::vector<std::ptrdiff_t>& origin,
              int row,
              int other,
              NormalEquations& normal) {
    const int columns = texel.grid.x, rows = texel.grid.y;
    const std::ptrdiff_t stride = texel.stride, leading = normal.leading;
    for (int x = 0; x + texel.width <= columns; ++x) {
        const auto begin = texel.corner_begin[static_cast<std::size_t>(
            x * rows + std::max(0, other - texel.height + 1))];
        const auto end = texel.corner_begin[static_cast<std::size_t>(x * rows + row + 1)];
        if (begin == end)
            continue;
        for (int p = 0; p < texel.width; p += kTileColumns)
            for (int q = 0; q < texel.stride; q += kTileRows)
                add_tile({std::span(origin).subspan(static_cast<std::size_t>(begin),
                                                    static_cast<std::size_t>(end - begin)),
                          normal.weighted.data() + row * stride + p,
                          texel.value.data() + other * stride + q},
                         normal.lower.data() + (row * columns + x + p) * leading +
                             (other * columns + x + q),
                         leading, std::min(kTileColumns, texel.width - p));
    }
}

void fill_weighted(const TexelDesign& texel,
                   std::span<const double> weight,
                   NormalEquations& normal) {
    normal.weighted.resize(texel.value.size());
    for (int k = 0; k < texel.measurement_count; ++k) {
        const double w = weight[static_cast<std::size_t>(k)];
        const std::size_t end = texel.block(k + 1);
        for (std::size_t at = texel.block(k); at < end; at += kVector)
            four(&normal.weighted[at]) = four(&texel.value[at]) * w;
    }
}

double dot_block(const TexelDesign& texel, int k, const double* coeffs) {
    const double* block = &texel.value[texel.block(k)];
    const double* c = coeffs + texel.first[static_cast<std::size_t>(k)];
    Four sum = Four::Zero();
    for (int row = 0; row < texel.height; ++row, block += texel.stride, c += texel.grid.x)
        for (int v = 0; v < texel.stride; v += kVector)
            sum += four(block + v) * four(c + v);
    return sum.sum();
}

void add_block(const TexelDesign& texel, int k, double factor, double* gradient) {
    const double* block = &texel.value[texel.block(k)];
    double* g = gradient + texel.first[static_cast<std::size_t>(k)];
    for (int row = 0; row < texel.height; ++row, block += texel.stride, g += texel.grid.x)
        for (int v = 0; v < texel.stride; v += kVector)
            four(g + v) += four(block + v) * factor;
}

// Differences' weights: lambda times the harmonic mean of what the data alone say about their
// coefficients, those that no measurement sees left out.
void fill_penalty_weights(const Penalty& penalty, double lambda, NormalEquations& normal) {
    normal.penalty_weight.clear();
    if (lambda == 0.0)
        return;
    const auto diagonal = [&](int m) { return normal.entry(m, m); };
    double all_inverse = 0.0, all_seen = 0.0;
    for (int m = 0; m < normal.size; ++m)
        if (diagonal(m) > 0.0) {
            all_inverse += 1.0 / diagonal(m);
            all_seen += 1.0;
        }
    for (const Penalty::Difference& difference : penalty.differences) {
        double inverse = 0.0, seen = 0.0;
        for (std::size_t p = 0; p < penalty.stencil.size(); ++p)
            if (const double d = diagonal(difference.first + static_cast<int>(p) * difference.step);
                d > 0.0) {
                inverse += 1.0 / d;
                seen += 1.0;
            }
        const bool is_any_seen = seen > 0.0;
        normal.penalty_weight.push_back(
            is_any_seen ? lambda * seen / inverse
                        : (all_seen > 0.0 ? lambda * all_seen / all_inverse : 0.0));
    }
}

void add_penalty(const Penalty& penalty, NormalEquations& normal) {
    const auto length = static_cast<int>(penalty.stencil.size());
    for (std::size_t d = 0; d < normal.penalty_weight.size(); ++d)
        for (int p = 0; p < length; ++p)
            for (int q = 0; q <= p; ++q) {
                const auto [first, step] = penalty.differences[d];
                normal.lower[static_cast<std::size_t>(first + q * step) *
                                 static_cast<std::size_t>(normal.leading) +
                             static_cast<std::size_t>(first + p * step)] +=
                    normal.penalty_weight[d] * penalty.stencil[static_cast<std::size_t>(p)] *
                    penalty.stencil[static_cast<std::size_t>(q)];
            }
}

// The right side and the data's length.
void set_data(const TexelDesign& texel,
              std::span<const double> b,
              std::span<const double> weight,
              NormalEquations& normal) {
    normal.rhs.assign(static_cast<std::size_t>(normal.leading), 0.0);
    double data_norm2 = 0.0;
    for (int k = 0; k < texel.measurement_count; ++k) {
        const double w = weight[static_cast<std::size_t>(k)];
        const double datum = b[static_cast<std::size_t>(k)];
        if (w == 0.0)
            continue;
        data_norm2 += w * datum * datum;
        add_block(texel, k, w * datum, normal.rhs.data());
    }
    normal.data_norm = std::sqrt(data_norm2);
}

}  // namespace

Penalty difference_penalty(glm::ivec2 grid, int order) {
    Penalty penalty;
    penalty.stencil = order == 1 ? std::vector<double>{-1, 1} : std::vector<double>{1, -2, 1};
    penalty.reach = order;
    for (int row = 0; row < grid.y; ++row)
        for (int column = 0; column < grid.x; ++column) {
            const int m = row * grid.x + column;
            if (column + order < grid.x)
                penalty.differences.push_back({m, 1});
            if (row + order < grid.y)
                penalty.differences.push_back({m, grid.x});
        }
    return penalty;
}

void form_normal(const TexelDesign& texel,
                 const Penalty& penalty,
                 std::span<const double> b,
                 std::span<const double> weight,
                 double lambda,
                 NormalEquations& normal) {
    normal.size = texel.grid.x * texel.grid.y;
    normal.leading = (normal.size + texel.stride + kVector - 1) / kVector * kVector;
    const auto n = static_cast<std::size_t>(normal.size);
    const auto leading = static_cast<std::size_t>(normal.leading);
    normal.lower.assign(n * leading, 0.0);
    normal.valid_count = static_cast<int>(
        std::count_if(weight.begin(), weight.end(), [](double w) { return w > 0.0; }));
    fill_weighted(texel, weight, normal);
    std::vector<std::ptrdiff_t> origin;
    origin.reserve(weight.size());
    for (const int k : texel.by_corner)
        origin.push_back(static_cast<std::ptrdiff_t>(texel.block(k)) -
                         texel.first[static_cast<std::size_t>(k)] / texel.grid.x *
                             std::ptrdiff_t{texel.stride});
    for (int row = 0; row < texel.grid.y; ++row)
        for (int other = row; other < std::min(row + texel.height, texel.grid.y); ++other)
            add_rows(texel, origin, row, other, normal);
    set_data(texel, b, weight, normal);
    fill_penalty_weights(penalty, lambda, normal);
    add_penalty(penalty, normal);
    normal.norm.resize(n);
    for (std::size_t m = 0; m < n; ++m)
        normal.norm[m] = std::sqrt(normal.lower[m * leading + m]);
}

void fill_gradient(const std::vector<double>& coeffs,
                   const std::vector<int>& row_end,
                   const NormalEquations& normal,
                   std::vector<double>& gradient) {
    gradient.assign(static_cast<std::size_t>(normal.leading), 0.0);
    for (int j = 0; j < normal.size; ++j) {
        const double* column =
            &normal.lower[static_cast<std::size_t>(j) * static_cast<std::size_t>(normal.leading)];
        const int end = row_end[static_cast<std::size_t>(j)];
        const Four factor = Four::Constant(coeffs[static_cast<std::size_t>(j)]);
        Four sum = Four::Zero();
        int i = j + 1;
        for (; i + kVector <= end; i += kVector) {
            const Four entries = four(column + i);
            four(&gradient[static_cast<std::size_t>(i)]) += entries * factor;
            sum += entries * four(&coeffs[static_cast<std::size_t>(i)]);
        }
        double rest = 0.0;
        for (; i < end; ++i) {
            gradient[static_cast<std::size_t>(i)] += column[i] * factor[0];
            rest += column[i] * coeffs[static_cast<std::size_t>(i)];
        }
        const auto at = static_cast<std::size_t>(j);
        gradient[at] += column[j] * coeffs[at] + sum.sum() + rest - normal.rhs[at];
    }
}

void fill_gradient(const TexelDesign& texel,
                   const Penalty& penalty,
                   std::span<const double> b,
                   std::span<const double> weight,
                   const NormalEquations& normal,
                   const std::vector<double>& coeffs,
                   std::vector<double>& residual,
                   std::vector<double>& gradient) {
    residual.assign(b.size(), 0.0);
    gradient.assign(static_cast<std::size_t>(normal.leading), 0.0);
    for (int k = 0; k < texel.measurement_count; ++k) {
        const auto at = static_cast<std::size_t>(k);
        if (weight[at] == 0.0)
            continue;
        residual[at] = dot_block(texel, k, coeffs.data()) - b[at];
        add_block(texel, k, weight[at] * residual[at], gradient.data());
    }
    for (std::size_t d = 0; d < normal.penalty_weight.size(); ++d) {
        const auto first = static_cast<std::size_t>(penalty.differences[d].first);
        const auto step = static_cast<std::size_t>(penalty.differences[d].step);
        double difference = 0.0;
        for (std::size_t p = 0; p < penalty.stencil.size(); ++p)
            difference += penalty.stencil[p] * coeffs[first + p * step];
        for (std::size_t p = 0; p < penalty.stencil.size(); ++p)
            gradient[first + p * step] +=
                normal.penalty_weight[d] * penalty.stencil[p] * difference;
    }
}

}  // namespace nearfield::fit
