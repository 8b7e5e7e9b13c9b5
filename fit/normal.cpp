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

// A tile of N: kTileColumns columns of kTileRows rows, sums that fit the registers.
constexpr int kTileColumns = 4;
constexpr int kTileRows = kSpreadRow;

// One measurement's share of N between two rows of the basis grid: weight left right^T.
struct RowPair {
    const double* left = nullptr;
    const double* right = nullptr;
    double weight = 0;
    int begin = 0;  // first column that is not 0
};

bool is_apart(const RowPair& pair, int width, int begin, int count) {
    return pair.begin + width <= begin || pair.begin >= begin + count;
}

struct TileColumn {
    Four low = Four::Zero(), middle = Four::Zero(), high = Four::Zero();

    void add(const TileColumn& right, double factor) {
        low += right.low * factor;
        middle += right.middle * factor;
        high += right.high * factor;
    }
    void write(double* to) const {
        four(to) = low;
        four(to + kVector) = middle;
        four(to + 2 * std::ptrdiff_t{kVector}) = high;
    }
};

// Sums a tile over all measurements and writes its first `count` columns. Four variables, not an
// array: an array stays in memory.
void write_tile(const std::vector<RowPair>& pairs,
                int width,
                glm::ivec2 begin,
                double* to,
                std::ptrdiff_t leading,
                int count) {
    TileColumn sum0, sum1, sum2, sum3;
    for (const RowPair& pair : pairs) {
        if (is_apart(pair, width, begin.x, kTileColumns) ||
            is_apart(pair, width, begin.y, kTileRows))
            continue;
        const double* r = pair.right + begin.y;
        const TileColumn right{four(r), four(r + kVector), four(r + 2 * std::ptrdiff_t{kVector})};
        const double* left = pair.left + begin.x;
        sum0.add(right, pair.weight * left[0]);
        sum1.add(right, pair.weight * left[1]);
        sum2.add(right, pair.weight * left[2]);
        sum3.add(right, pair.weight * left[3]);
    }
    sum0.write(to);
    if (count > 1)
        sum1.write(to + leading);
    if (count > 2)
        sum2.write(to + 2 * leading);
    if (count > 3)
        sum3.write(to + 3 * leading);
}

// Part of N between rows `row` and `other` >= row of the basis grid. What a tile writes past the
// grid's last column is 0 or written again by the next row's.
void write_rows(const TexelDesign& texel,
                const std::vector<glm::ivec2>& corner,
                std::span<const double> weight,
                int row,
                int other,
                std::vector<RowPair>& pairs,
                NormalEquations& normal) {
    const int columns = texel.grid.x;
    const auto wide = static_cast<std::size_t>(texel.wide);
    pairs.clear();
    for (int k = 0; k < texel.measurement_count; ++k) {
        const int first_row = corner[static_cast<std::size_t>(k)].y;
        const double w = weight[static_cast<std::size_t>(k)];
        if (row < first_row || other >= first_row + texel.height || w == 0.0)
            continue;
        const auto rows = static_cast<std::size_t>(k * texel.height);
        pairs.push_back({&texel.spread[(rows + static_cast<std::size_t>(row - first_row)) * wide],
                         &texel.spread[(rows + static_cast<std::size_t>(other - first_row)) * wide],
                         w, texel.first[static_cast<std::size_t>(k)] % columns});
    }
    for (int p = 0; p < columns; p += kTileColumns)
        for (int q = 0; q < columns; q += kTileRows)
            write_tile(pairs, texel.width, {p, q},
                       &normal.lower[static_cast<std::size_t>(row * columns + p) *
                                         static_cast<std::size_t>(normal.leading) +
                                     static_cast<std::size_t>(other * columns + q)],
                       normal.leading, std::min(kTileColumns, columns - p));
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
    normal.leading =
        (normal.size + std::max(texel.stride, kTileRows) + kVector - 1) / kVector * kVector;
    const auto n = static_cast<std::size_t>(normal.size);
    const auto leading = static_cast<std::size_t>(normal.leading);
    normal.lower.assign(n * leading, 0.0);
    normal.valid_count = static_cast<int>(
        std::count_if(weight.begin(), weight.end(), [](double w) { return w > 0.0; }));
    std::vector<RowPair> pairs;
    pairs.reserve(weight.size());
    std::vector<glm::ivec2> corner;  // divided once: 42 pairs of rows look at all measurements
    corner.reserve(weight.size());
    for (const int first : texel.first)
        corner.emplace_back(first % texel.grid.x, first / texel.grid.x);
    for (int row = 0; row < texel.grid.y; ++row)
        for (int other = row; other < std::min(row + texel.height, texel.grid.y); ++other)
            write_rows(texel, corner, weight, row, other, pairs, normal);
    set_data(texel, b, weight, normal);
    fill_penalty_weights(penalty, lambda, normal);
    add_penalty(penalty, normal);
    normal.norm.resize(n);
    for (std::size_t m = 0; m < n; ++m)
        normal.norm[m] = std::sqrt(normal.lower[m * leading + m]);
}

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
