// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace nearfield::fit {

constexpr int kColumnBlock = 4;  // columns are factored that many at a time

/// A symmetric positive definite matrix, its lower half column by column, whose row i starts at
/// column first[i] (rising); after factorize() the factor L of L L^T in its place. Columns can be
/// left out: what is solved for is then 0 there, and the factor's column too.
struct BandMatrix {
    int size = 0;
    int padded = 0;                    // size to whole blocks of columns
    int leading = 0;                   // distance of columns; room for whole blocks of rows
    int factored = 0;                  // columns that stand factored; the others are left out
    std::vector<std::uint8_t> is_out;  // [padded]; past `size` all are
    std::vector<int> first;            // [padded]
    std::vector<int> row_end;          // [padded]: one past the last row of column j
    std::vector<double> value;
    std::vector<double> inverse_diagonal;  // of the factor
    /// Right sides have this length: zeros past `size`.
    int vector_size() const { return leading; }
};

/// Makes room for a matrix whose `first` has been set for `size` rows, no column left out or
/// factored. Entries in the band are to be written by the caller, in whole columns from the
/// diagonal to row_end; zeros that the factorization reads beyond stand there.
void reset(BandMatrix& matrix, int size);

/// A pivot that rounding makes smaller than 1e-14 of its diagonal entry is raised to that.
/// Columns from `begin` on (a multiple of kColumnBlock, at most `factored`) hold entries of the
/// matrix where they are not left out, those before stand factored. Rows of columns that are left
/// out are factored with the others, so that these can come back later from where they stand. Cost
/// size * band^2 / 2 multiply-adds from column 0, 5 to 8 of them a cycle (AVX2).
void factorize(BandMatrix& matrix, int begin = 0);

/// x <- L^-T L^-1 x.
void solve(const BandMatrix& factor, double* x);

constexpr int kLanes = 8;
/// x <- L^-1 x and x <- L^-T x for eight right sides at once, x[row][lane] of `padded` rows, zeros
/// past `size` and, of the first, before first_row.
void solve_lower(const BandMatrix& factor, int first_row, double* x);
void solve_upper(const BandMatrix& factor, double* x);

}  // namespace nearfield::fit
