// SPDX-License-Identifier: Apache-2.0
#include "fit/band_cholesky.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::fit {
namespace {

constexpr int kBlock = kColumnBlock;
constexpr int kChunk = 8;  // rows at a time: with 4 columns, sums that fit the registers
constexpr double kLeastPivot = 1e-14;

using Rows4 = Eigen::Array<double, 4, 1>;
using Lanes = Eigen::Array<double, kLanes, 1>;
using Tall = Eigen::Matrix<double, kChunk, kBlock>;
using Square = Eigen::Matrix<double, kBlock, kBlock>;

template <typename Rows>
Eigen::Map<Rows> at(double* p) {
    return Eigen::Map<Rows>(p);
}

template <typename Rows>
Eigen::Map<const Rows> at(const double* p) {
    return Eigen::Map<const Rows>(p);
}

const double* column(const BandMatrix& matrix, int j) {
    return &matrix.value[static_cast<std::size_t>(j) * static_cast<std::size_t>(matrix.leading)];
}

double* column(BandMatrix& matrix, int j) {
    return &matrix.value[static_cast<std::size_t>(j) * static_cast<std::size_t>(matrix.leading)];
}

double* lanes_of(double* x, int row) {
    return x + static_cast<std::ptrdiff_t>(row) * kLanes;
}

// One past the last row that any of four columns reaches, the block itself at least.
int block_end(const BandMatrix& matrix, int j0) {
    return std::max(matrix.row_end[static_cast<std::size_t>(j0 + kBlock - 1)], j0 + kBlock);
}

// A[i..i+7, j0..j0+3] -= L[i..i+7, k] L[j0..j0+3, k]^T over columns k before the block, four of
// them at a time: a product of small matrices, which Eigen fuses. Columns of a block before the
// first that reaches row i hold zeros there.
void update_chunk(BandMatrix& matrix, int j0, int i) {
    const Eigen::OuterStride<> apart(matrix.leading);
    Eigen::Map<Tall, 0, Eigen::OuterStride<>> rows(column(matrix, j0) + i, apart);
    Tall sum = rows;
    for (int k = matrix.first[static_cast<std::size_t>(i)] / kBlock * kBlock; k < j0; k += kBlock) {
        const Eigen::Map<const Tall, 0, Eigen::OuterStride<>> left(column(matrix, k) + i, apart);
        const Eigen::Map<const Square, 0, Eigen::OuterStride<>> right(column(matrix, k) + j0,
                                                                      apart);
        sum.noalias() -= left.lazyProduct(right.transpose());
    }
    rows = sum;
}

// Cholesky factorization of the block on the diagonal.
void factorize_block(BandMatrix& matrix, int j0, const double* diagonal) {
    for (int c = 0; c < kBlock; ++c) {
        double* col = column(matrix, j0 + c) + j0;
        for (int d = 0; d < c; ++d) {
            const double* before = column(matrix, j0 + d) + j0;
            for (int r = c; r < kBlock; ++r)
                col[r] -= before[r] * before[c];
        }
        if (matrix.is_out[static_cast<std::size_t>(j0 + c)] != 0) {
            matrix.inverse_diagonal[static_cast<std::size_t>(j0 + c)] = 0.0;
            std::fill(col, col + kBlock, 0.0);
            continue;
        }
        const double inverse = 1.0 / std::sqrt(std::max(col[c], kLeastPivot * diagonal[c]));
        matrix.inverse_diagonal[static_cast<std::size_t>(j0 + c)] = inverse;
        for (int r = c; r < kBlock; ++r)
            col[r] *= inverse;
        col[c] = 1.0 / inverse;
    }
}

// Rows below the block: X <- X L_block^-T.
void finish_rows(BandMatrix& matrix, int j0, int i) {
    const std::ptrdiff_t leading = matrix.leading;
    double* p = column(matrix, j0) + i;
    const double* l = column(matrix, j0) + j0;
    const double* inverse = &matrix.inverse_diagonal[static_cast<std::size_t>(j0)];
    const Rows4 x0 = at<Rows4>(p) * inverse[0];
    const Rows4 x1 = (at<Rows4>(p + leading) - x0 * l[1]) * inverse[1];
    const Rows4 x2 = (at<Rows4>(p + 2 * leading) - x0 * l[2] - x1 * l[leading + 2]) * inverse[2];
    const Rows4 x3 =
        (at<Rows4>(p + 3 * leading) - x0 * l[3] - x1 * l[leading + 3] - x2 * l[2 * leading + 3]) *
        inverse[3];
    at<Rows4>(p) = x0;
    at<Rows4>(p + leading) = x1;
    at<Rows4>(p + 2 * leading) = x2;
    at<Rows4>(p + 3 * leading) = x3;
}

// Zeros where a chunk of rows or a block of columns reaches past a column's last row.
void clear_beyond(BandMatrix& matrix, int j) {
    const int begin = j < matrix.size ? matrix.row_end[static_cast<std::size_t>(j)] : j;
    const int end = block_end(matrix, j / kBlock * kBlock) + kChunk;
    std::fill(column(matrix, j) + begin, column(matrix, j) + std::min(matrix.leading, end), 0.0);
}

}  // namespace

void reset(BandMatrix& matrix, int size) {
    matrix.size = size;
    matrix.padded = (size + kBlock - 1) / kBlock * kBlock;
    matrix.leading = matrix.padded + kChunk;
    matrix.value.resize(static_cast<std::size_t>(matrix.padded) *
                        static_cast<std::size_t>(matrix.leading));
    matrix.inverse_diagonal.resize(static_cast<std::size_t>(matrix.padded));
    matrix.first.resize(static_cast<std::size_t>(matrix.padded));
    matrix.row_end.resize(static_cast<std::size_t>(matrix.padded));
    int end = 0;
    for (int j = 0; j < size; ++j) {
        while (end < size && matrix.first[static_cast<std::size_t>(end)] <= j)
            ++end;
        matrix.row_end[static_cast<std::size_t>(j)] = end;
    }
    for (int j = size; j < matrix.padded; ++j) {
        matrix.first[static_cast<std::size_t>(j)] = j;
        matrix.row_end[static_cast<std::size_t>(j)] = j + 1;
    }
    for (int j = 0; j < matrix.padded; ++j)
        clear_beyond(matrix, j);
    matrix.is_out.assign(static_cast<std::size_t>(matrix.padded), 0);
    std::fill(matrix.is_out.begin() + size, matrix.is_out.end(), 1);
    matrix.factored = 0;
}

void factorize(BandMatrix& matrix, int begin) {
    int kept = matrix.padded;
    while (kept > 0 && matrix.is_out[static_cast<std::size_t>(kept - 1)] != 0)
        --kept;
    matrix.factored = (kept + kBlock - 1) / kBlock * kBlock;
    for (int j0 = begin; j0 < matrix.factored; j0 += kBlock) {
        double diagonal[kBlock];
        for (int c = 0; c < kBlock; ++c)
            diagonal[c] = column(matrix, j0 + c)[j0 + c];
        const int end = block_end(matrix, j0);
        for (int j = j0; j < j0 + kBlock; ++j)
            if (matrix.is_out[static_cast<std::size_t>(j)] != 0)
                std::fill(column(matrix, j) + j0,
                          column(matrix, j) + std::min(matrix.leading, end + kChunk), 0.0);
        for (int i = j0; i < end; i += kChunk)
            update_chunk(matrix, j0, i);
        factorize_block(matrix, j0, diagonal);
        for (int i = j0 + kBlock; i < end; i += kBlock)
            finish_rows(matrix, j0, i);
    }
}

void solve(const BandMatrix& factor, double* x) {
    const std::ptrdiff_t leading = factor.leading;
    for (int j0 = 0; j0 < factor.factored; j0 += kBlock) {
        const double* l = column(factor, j0);
        for (int c = 0; c < kBlock; ++c) {
            for (int d = 0; d < c; ++d)
                x[j0 + c] -= l[d * leading + j0 + c] * x[j0 + d];
            x[j0 + c] *= factor.inverse_diagonal[static_cast<std::size_t>(j0 + c)];
        }
        const int end = std::min(block_end(factor, j0), factor.factored);
        for (int i = j0 + kBlock; i < end; i += kBlock)
            at<Rows4>(x + i) -= at<Rows4>(l + i) * x[j0] + at<Rows4>(l + leading + i) * x[j0 + 1] +
                                at<Rows4>(l + 2 * leading + i) * x[j0 + 2] +
                                at<Rows4>(l + 3 * leading + i) * x[j0 + 3];
    }
    for (int j0 = factor.factored - kBlock; j0 >= 0; j0 -= kBlock) {
        const double* l = column(factor, j0);
        Rows4 sum0 = Rows4::Zero(), sum1 = sum0, sum2 = sum0, sum3 = sum0;
        const int end = std::min(block_end(factor, j0), factor.factored);
        for (int i = j0 + kBlock; i < end; i += kBlock) {
            const Rows4 rows = at<Rows4>(x + i);
            sum0 += at<Rows4>(l + i) * rows;
            sum1 += at<Rows4>(l + leading + i) * rows;
            sum2 += at<Rows4>(l + 2 * leading + i) * rows;
            sum3 += at<Rows4>(l + 3 * leading + i) * rows;
        }
        const double sums[kBlock] = {sum0.sum(), sum1.sum(), sum2.sum(), sum3.sum()};
        for (int c = kBlock - 1; c >= 0; --c) {
            x[j0 + c] -= sums[c];
            for (int d = c + 1; d < kBlock; ++d)
                x[j0 + c] -= l[c * leading + j0 + d] * x[j0 + d];
            x[j0 + c] *= factor.inverse_diagonal[static_cast<std::size_t>(j0 + c)];
        }
    }
}

void solve_lower(const BandMatrix& factor, int first_row, double* x) {
    const std::ptrdiff_t leading = factor.leading;
    for (int j0 = first_row / kBlock * kBlock; j0 < factor.factored; j0 += kBlock) {
        const double* l = column(factor, j0);
        Lanes pivot[kBlock];
        for (int c = 0; c < kBlock; ++c) {
            pivot[c] = at<Lanes>(lanes_of(x, j0 + c));
            for (int d = 0; d < c; ++d)
                pivot[c] -= pivot[d] * l[d * leading + j0 + c];
            pivot[c] *= factor.inverse_diagonal[static_cast<std::size_t>(j0 + c)];
            at<Lanes>(lanes_of(x, j0 + c)) = pivot[c];
        }
        const int end = std::min(block_end(factor, j0), factor.factored);
        for (int i = j0 + kBlock; i < end; ++i)
            at<Lanes>(lanes_of(x, i)) -= pivot[0] * l[i] + pivot[1] * l[leading + i] +
                                         pivot[2] * l[2 * leading + i] +
                                         pivot[3] * l[3 * leading + i];
    }
}

void solve_upper(const BandMatrix& factor, double* x) {
    const std::ptrdiff_t leading = factor.leading;
    for (int j0 = factor.factored - kBlock; j0 >= 0; j0 -= kBlock) {
        const double* l = column(factor, j0);
        Lanes sum[kBlock];
        for (int c = 0; c < kBlock; ++c)
            sum[c] = at<Lanes>(lanes_of(x, j0 + c));
        const int end = std::min(block_end(factor, j0), factor.factored);
        for (int i = j0 + kBlock; i < end; ++i) {
            const Lanes row = at<Lanes>(lanes_of(x, i));
            for (int c = 0; c < kBlock; ++c)
                sum[c] -= row * l[c * leading + i];
        }
        for (int c = kBlock - 1; c >= 0; --c) {
            for (int d = c + 1; d < kBlock; ++d)
                sum[c] -= sum[d] * l[c * leading + j0 + d];
            sum[c] *= factor.inverse_diagonal[static_cast<std::size_t>(j0 + c)];
            at<Lanes>(lanes_of(x, j0 + c)) = sum[c];
        }
    }
}

}  // namespace nearfield::fit
