// SPDX-License-Identifier: Apache-2.0
#include "fit/free_factor.h"

#include <algorithm>

namespace nearfield::fit {
namespace {

// Added to N's diagonal, relative: makes N definite where measurements miss and lambda is 0. Above
// rounding (n eps = 2e-14), far below what data determine.
constexpr double kRidge = 1e-12;

// Whether one dense factorization and the ends of some more cost less than banded ones at every
// change, of which a texel takes four.
bool is_dense_cheaper(double n, double width) {
    constexpr double kBanded = 4.0, kDense = 1.6;
    return kDense * n * n * n / 6.0 < kBanded * (n / 2.0 - width / 3.0) * width * width;
}

void set_profile(const Band& band, FreeFactor& factor) {
    std::vector<int>& first = factor.matrix.first;
    first.assign(factor.order.size(), 0);
    if (!factor.keeps_places) {
        int begin = 0;
        for (std::size_t i = 0; i < first.size(); ++i) {
            const int least = band.begin[static_cast<std::size_t>(factor.order[i])];
            while (factor.order[static_cast<std::size_t>(begin)] < least)
                ++begin;
            first[i] = begin;
        }
    }
    reset(factor.matrix, static_cast<int>(first.size()));
}

// Writes the free columns from `begin` on over what the factor has there.
void gather(const NormalEquations& normal, int begin, FreeFactor& factor) {
    BandMatrix& matrix = factor.matrix;
    for (const int j : factor.free_place) {
        if (j < begin)
            continue;
        double* to =
            &matrix.value[static_cast<std::size_t>(j) * static_cast<std::size_t>(matrix.leading)];
        const int column = factor.order[static_cast<std::size_t>(j)];
        const int end = matrix.row_end[static_cast<std::size_t>(j)];
        for (int i = j; i < end; ++i) {
            const int row = factor.order[static_cast<std::size_t>(i)];
            to[i] = normal.entry(std::max(row, column), std::min(row, column));
        }
        to[j] *= 1.0 + kRidge;
    }
}

}  // namespace

void fill_band(glm::ivec2 grid, glm::ivec2 reach, Band& band) {
    if (band.grid == grid && band.reach == reach)
        return;
    band.grid = grid;
    band.reach = reach;
    const int count = grid.x * grid.y;
    band.begin.clear();
    band.width = 0;
    // Before all that share a measurement or a difference with m, rising: hence 0 in the first
    // rows, where the reach is cut off.
    for (int m = 0; m < count; ++m) {
        const int row = m / grid.x - reach.y;
        band.begin.push_back(row < 0 ? 0 : row * grid.x + std::max(0, m % grid.x - reach.x));
        band.width = std::max(band.width, m - band.begin.back());
    }
    band.row_end.clear();
    int end = 0;
    for (int m = 0; m < count; ++m) {
        while (end < count && band.begin[static_cast<std::size_t>(end)] <= m)
            ++end;
        band.row_end.push_back(end);
    }
}

void start(const Band& band,
           const NormalEquations& normal,
           std::span<const std::uint8_t> is_free,
           std::span<const double> last_coeffs,
           FreeFactor& factor) {
    factor.keeps_places = is_dense_cheaper(normal.size, band.width);
    factor.order.clear();
    for (int m = 0; m < normal.size; ++m)
        if (is_free[static_cast<std::size_t>(m)] != 0)
            factor.order.push_back(m);
    if (factor.keeps_places) {
        if (!last_coeffs.empty())
            std::sort(factor.order.begin(), factor.order.end(), [&](int a, int b) {
                const double left = last_coeffs[static_cast<std::size_t>(a)];
                const double right = last_coeffs[static_cast<std::size_t>(b)];
                return left > right || (left == right && a < b);
            });
        for (int m = 0; m < normal.size; ++m)
            if (is_free[static_cast<std::size_t>(m)] == 0 &&
                normal.norm[static_cast<std::size_t>(m)] > 0.0)
                factor.order.push_back(m);
    }
    set_profile(band, factor);
}

void follow(const Band& band,
            const NormalEquations& normal,
            std::span<const std::uint8_t> is_free,
            FreeFactor& factor) {
    if (!factor.keeps_places)
        start(band, normal, is_free, {}, factor);
    BandMatrix& matrix = factor.matrix;
    int begin = matrix.factored;
    factor.free_place.clear();
    for (int place = 0; place < matrix.size; ++place) {
        const auto at = static_cast<std::size_t>(place);
        const bool is_out = is_free[static_cast<std::size_t>(factor.order[at])] == 0;
        if (!is_out)
            factor.free_place.push_back(place);
        if (is_out != (matrix.is_out[at] != 0)) {
            matrix.is_out[at] = is_out ? 1 : 0;
            begin = std::min(begin, place);
        }
    }
    begin = begin / kColumnBlock * kColumnBlock;
    gather(normal, begin, factor);
    factorize(matrix, begin);
}

void minimum_of_free(const FreeFactor& factor,
                     const std::vector<double>& rhs,
                     std::vector<double>& right_side,
                     std::vector<double>& coeffs) {
    right_side.assign(static_cast<std::size_t>(factor.matrix.vector_size()), 0.0);
    const auto m_at = [&](int place) {
        return static_cast<std::size_t>(factor.order[static_cast<std::size_t>(place)]);
    };
    for (const int place : factor.free_place)
        right_side[static_cast<std::size_t>(place)] = rhs[m_at(place)];
    solve(factor.matrix, right_side.data());
    std::fill(coeffs.begin(), coeffs.end(), 0.0);
    for (const int place : factor.free_place)
        coeffs[m_at(place)] = right_side[static_cast<std::size_t>(place)];
}

}  // namespace nearfield::fit
