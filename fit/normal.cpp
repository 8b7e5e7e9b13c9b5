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

// N += w g g^T, rectangle by rectangle; what is written above the diagonal stays within the column.
void add_measurement(const TexelDesign& texel, int k, double weight, NormalEquations& normal) {
    const int first = texel.first[static_cast<std::size_t>(k)];
    const double* block = &texel.value[texel.block(k)];
    for (int row = 0; row < texel.height; ++row)
        for (int a = 0; a < texel.width; ++a) {
            const double factor = weight * block[row * texel.stride + a];
            const int m = first + row * texel.grid.x + a;
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
    normal.leading = (normal.size + texel.stride + kVector - 1) / kVector * kVector;
    const auto n = static_cast<std::size_t>(normal.size);
    const auto leading = static_cast<std::size_t>(normal.leading);
    normal.lower.assign(n * leading, 0.0);
    normal.valid_count = 0;
    for (int k = 0; k < texel.measurement_count; ++k) {
        const double w = weight[static_cast<std::size_t>(k)];
        if (w == 0.0)
            continue;
        ++normal.valid_count;
        add_measurement(texel, k, w, normal);
    }
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
