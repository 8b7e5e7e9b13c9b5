// SPDX-License-Identifier: Apache-2.0
/// The Cholesky factor of N's free part, which follows the set of free coefficients.
#pragma once

#include "fit/band_cholesky.h"
#include "fit/normal.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::fit {

/// Where N has entries: between basis functions at most `reach` columns and rows of the grid apart.
struct Band {
    glm::ivec2 grid{0}, reach{0};
    std::vector<int> begin;    // [m]: first column of row m, rising
    std::vector<int> row_end;  // [m]: one past the last row of column m
    int width = 0;             // most entries left of the diagonal
};

/// Leaves a band as it is that is right already.
void fill_band(glm::ivec2 grid, glm::ivec2 reach, Band& band);

/// Small or dense N: all coefficients have a place, bound ones are left out of the factor, and
/// those that were brightest in the texel before come first. A change of sides leaves the factor's
/// columns before it as they are, and mostly dim coefficients change. Large N: the free ones in the
/// grid's order, so that the band stays narrow, factored anew at every change.
struct FreeFactor {
    BandMatrix matrix;
    std::vector<int> order;       // [place]: m
    std::vector<int> free_place;  // rising
    bool keeps_places = false;
};

/// Chooses places for a new N. last_coeffs: [m] of the texel before, or empty.
void start(const Band& band,
           const NormalEquations& normal,
           std::span<const std::uint8_t> is_free,
           std::span<const double> last_coeffs,
           FreeFactor& factor);

/// Factors N's part of the coefficients that are free; `start` was called for this N.
/// Cost    n^3 / 6 multiply-adds at first where places are kept, then those of the columns from the
///         first change on; else n band^2 / 2
void follow(const Band& band,
            const NormalEquations& normal,
            std::span<const std::uint8_t> is_free,
            FreeFactor& factor);

/// The minimum over the free coefficients, [m]; 0 elsewhere. `right_side` is scratch.
void minimum_of_free(const FreeFactor& factor,
                     const std::vector<double>& rhs,
                     std::vector<double>& right_side,
                     std::vector<double>& coeffs);

}  // namespace nearfield::fit
