// SPDX-License-Identifier: Apache-2.0
// The banded factorization against multiplying back, in memory that is dirty.
#include "fit/band_cholesky.h"

#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nearfield::fit {
namespace {

constexpr double kDirt = std::numeric_limits<double>::quiet_NaN();

// A diagonally dominant matrix whose rows start at rising columns with jumps, [row][column].
std::vector<double> random_band(int size, std::uint64_t seed, std::vector<int>& first) {
    support::Random random{seed};
    const auto n = static_cast<std::size_t>(size);
    std::vector<double> a(n * n, 0.0);
    first.assign(n, 0);
    for (std::size_t i = 1; i < n; ++i) {
        first[i] = first[i - 1];
        if (random.uniform() < 0.3)
            first[i] = std::min(static_cast<int>(i),
                                first[i] + static_cast<int>(random.uniform(0.0, 9.0)));
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (auto j = static_cast<std::size_t>(first[i]); j < i; ++j)
            a[i * n + j] = a[j * n + i] = random.uniform(-1.0, 1.0);
        a[i * n + i] = 2.0 * size;
    }
    return a;
}

TEST(BandCholesky, SolvesBandsOfAnyShapeInDirtyMemory) {
    BandMatrix matrix;
    for (int size = 1; size < 60; ++size) {
        std::vector<int> first;
        const std::vector<double> a = random_band(size, static_cast<std::uint64_t>(size), first);
        const auto n = static_cast<std::size_t>(size);
        std::fill(matrix.value.begin(), matrix.value.end(), kDirt);
        matrix.value.resize(std::size_t{72} * 72, kDirt);
        matrix.first = first;
        reset(matrix, size);
        for (int j = 0; j < size; ++j)
            for (int i = j; i < matrix.row_end[static_cast<std::size_t>(j)]; ++i)
                matrix.value[static_cast<std::size_t>(j * matrix.leading + i)] =
                    a[static_cast<std::size_t>(i) * n + static_cast<std::size_t>(j)];
        factorize(matrix);
        support::Random random{99};
        std::vector<double> truth, x(static_cast<std::size_t>(matrix.vector_size()), 0.0);
        std::vector<double> lanes(static_cast<std::size_t>(matrix.padded * kLanes), 0.0);
        for (std::size_t i = 0; i < n; ++i)
            truth.push_back(random.uniform(-1.0, 1.0));
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) {
                x[i] += a[i * n + j] * truth[j];
                for (std::size_t lane = 0; lane < kLanes; ++lane)
                    lanes[i * kLanes + lane] += static_cast<double>(lane) * a[i * n + j] * truth[j];
            }
        solve(matrix, x.data());
        solve_lower(matrix, 0, lanes.data());
        solve_upper(matrix, lanes.data());
        for (std::size_t i = 0; i < n; ++i) {
            ASSERT_NEAR(x[i], truth[i], 1e-13) << size;
            for (std::size_t lane = 0; lane < kLanes; ++lane)
                ASSERT_NEAR(lanes[i * kLanes + lane], static_cast<double>(lane) * truth[i], 1e-12)
                    << size;
        }
        // A right side that begins late.
        std::vector<double> late(lanes.size(), 0.0);
        late[static_cast<std::size_t>(size / 2 * kLanes + 3)] = 1.0;
        std::vector<double> whole = late;
        solve_lower(matrix, size / 2, late.data());
        solve_lower(matrix, 0, whole.data());
        ASSERT_EQ(late, whole);
    }
}

// Writes the columns that are not left out from `begin` on.
void write_columns(const std::vector<double>& a, int begin, BandMatrix& matrix) {
    const auto n = static_cast<std::size_t>(matrix.size);
    for (int j = begin; j < matrix.size; ++j)
        for (int i = j; matrix.is_out[static_cast<std::size_t>(j)] == 0 &&
                        i < matrix.row_end[static_cast<std::size_t>(j)];
             ++i)
            matrix.value[static_cast<std::size_t>(j * matrix.leading + i)] =
                a[static_cast<std::size_t>(i) * n + static_cast<std::size_t>(j)];
}

// Columns are left out and come back at random; the factor is made again from the first that
// changed. The truth is 0 where left out, and what is asked of left out rows does not matter.
TEST(BandCholesky, FollowsColumnsThatAreLeftOut) {
    for (const int size : {1, 7, 30, 41}) {
        std::vector<int> first;
        const std::vector<double> a = random_band(size, 5, first);
        const auto n = static_cast<std::size_t>(size);
        BandMatrix matrix;
        matrix.value.assign(std::size_t{60} * 60, kDirt);
        matrix.first = first;
        reset(matrix, size);
        support::Random random{static_cast<std::uint64_t>(size)};
        for (int change = 0; change < 40; ++change) {
            int begin = matrix.factored;
            for (int j = change % 3 == 0 ? 0 : size / 2; j < size; ++j) {
                const bool is_out = random.uniform() < 0.3;
                if (is_out != (matrix.is_out[static_cast<std::size_t>(j)] != 0))
                    begin = std::min(begin, j);
                matrix.is_out[static_cast<std::size_t>(j)] = is_out ? 1 : 0;
            }
            begin = begin / kColumnBlock * kColumnBlock;
            write_columns(a, begin, matrix);
            factorize(matrix, begin);
            std::vector<double> truth(n), x(static_cast<std::size_t>(matrix.vector_size()), 0.0);
            for (std::size_t i = 0; i < n; ++i)
                truth[i] = matrix.is_out[i] != 0 ? 0.0 : random.uniform(-1.0, 1.0);
            for (std::size_t i = 0; i < n; ++i)
                for (std::size_t j = 0; j < n && matrix.is_out[i] == 0; ++j)
                    x[i] += a[i * n + j] * truth[j];
            solve(matrix, x.data());
            for (std::size_t i = 0; i < n; ++i)
                ASSERT_NEAR(x[i], truth[i], 1e-13) << size << ", change " << change;
        }
    }
}

}  // namespace
}  // namespace nearfield::fit
