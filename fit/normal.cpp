// SPDX-License-Identifier: Apache-2.0
#include "fit/normal.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

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

// Differences along one axis: rows of D with 1 -1 or 1 -2 1, added to D^T D.
void add_differences(glm::ivec2 grid,
                     glm::ivec2 step,
                     const std::vector<double>& stencil,
                     std::map<std::pair<int, int>, double>& entries) {
    const int length = static_cast<int>(stencil.size());
    const glm::ivec2 end = grid - (length - 1) * step;
    const auto index = [&](glm::ivec2 at) { return at.y * grid.x + at.x; };
    for (int row = 0; row < end.y; ++row)
        for (int column = 0; column < end.x; ++column)
            for (int p = 0; p < length; ++p)
                for (int q = 0; q <= p; ++q)
                    entries[{index(glm::ivec2(column, row) + p * step),
                             index(glm::ivec2(column, row) + q * step)}] +=
                        stencil[static_cast<std::size_t>(p)] * stencil[static_cast<std::size_t>(q)];
}

// N += w g g^T, rectangle by rectangle; what is written above the diagonal stays within the column.
void add_measurement(
    const TexelDesign& texel, int k, double weight, double b, NormalEquations& normal) {
    const int first = texel.first[static_cast<std::size_t>(k)];
    const double* block = &texel.value[texel.block(k)];
    for (int row = 0; row < texel.height; ++row)
        for (int a = 0; a < texel.width; ++a) {
            const double factor = weight * block[row * texel.stride + a];
            const int m = first + row * texel.grid.x + a;
            normal.rhs[static_cast<std::size_t>(m)] += factor * b;
            double* to =
                &normal
                     .lower[static_cast<std::size_t>(m) * static_cast<std::size_t>(normal.leading) +
                            static_cast<std::size_t>(first)];
            for (int other = row; other < texel.height; ++other) {
                double* target = to + other * texel.grid.x;
                const double* from = block + other * texel.stride;
                for (int v = 0; v < texel.stride; v += kVector)
                    four(target + v) += four(from + v) * factor;
            }
        }
}

double dot_block(const TexelDesign& texel, int k, const double* coeffs) {
    const double* block = &texel.value[texel.block(k)];
    const double* c = coeffs + texel.first[static_cast<std::size_t>(k)];
    Four sum = Four::Zero();
    for (int row = 0; row < texel.height; ++row)
        for (int v = 0; v < texel.stride; v += kVector)
            sum += four(block + row * texel.stride + v) * four(c + row * texel.grid.x + v);
    return sum.sum();
}

void add_block(const TexelDesign& texel, int k, double factor, double* gradient) {
    const double* block = &texel.value[texel.block(k)];
    double* g = gradient + texel.first[static_cast<std::size_t>(k)];
    for (int row = 0; row < texel.height; ++row)
        for (int v = 0; v < texel.stride; v += kVector)
            four(g + row * texel.grid.x + v) += four(block + row * texel.stride + v) * factor;
}

}  // namespace

Penalty difference_penalty(glm::ivec2 grid, int order) {
    const std::vector<double> stencil =
        order == 1 ? std::vector<double>{-1, 1} : std::vector<double>{1, -2, 1};
    std::map<std::pair<int, int>, double> entries;
    add_differences(grid, {1, 0}, stencil, entries);
    add_differences(grid, {0, 1}, stencil, entries);
    Penalty penalty;
    for (const auto& [at, value] : entries)
        penalty.lower.push_back({at.first, at.second, value});
    penalty.reach = glm::ivec2(order);
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
    normal.rhs.assign(leading, 0.0);
    normal.valid_count = 0;
    double data_norm2 = 0.0;
    for (int k = 0; k < texel.measurement_count; ++k) {
        const double w = weight[static_cast<std::size_t>(k)];
        const double datum = b[static_cast<std::size_t>(k)];
        if (w == 0.0)
            continue;
        ++normal.valid_count;
        data_norm2 += w * datum * datum;
        add_measurement(texel, k, w, datum, normal);
    }
    normal.data_norm = std::sqrt(data_norm2);
    double trace = 0.0;
    for (std::size_t m = 0; m < n; ++m)
        trace += normal.lower[m * leading + m];
    normal.penalty_scale = lambda * trace / static_cast<double>(n);
    for (const Penalty::Entry& entry : penalty.lower)
        normal.lower[static_cast<std::size_t>(entry.column) * leading +
                     static_cast<std::size_t>(entry.row)] += normal.penalty_scale * entry.value;
    normal.norm.resize(n);
    for (std::size_t m = 0; m < n; ++m)
        normal.norm[m] = std::sqrt(normal.lower[m * leading + m]);
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
    if (normal.penalty_scale == 0.0)
        return;
    for (const Penalty::Entry& entry : penalty.lower) {
        const auto row = static_cast<std::size_t>(entry.row);
        const auto column = static_cast<std::size_t>(entry.column);
        const double value = normal.penalty_scale * entry.value;
        gradient[row] += value * coeffs[column];
        if (row != column)
            gradient[column] += value * coeffs[row];
    }
}

}  // namespace nearfield::fit
