// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield {

/// C_m at half the resolution of the level before: texel (i, j) is the mean over its 2 x 2 texels
/// there, texels beyond S's rectangle counted as zero (odd sizes round up), so every level holds
/// the same light.
struct MipLevel {
    glm::ivec2 texels{0};
    std::vector<float> coeffs;  // [channel][m][j][i]
};

/// What samplers and shadow maps need of one slab, in luminance, computed from C_m alone
/// (model/tables.h). S coordinates; "integral" is over S in m^2.
struct SlabTables {
    std::vector<float> total;  // [m] integral of C_m
    std::vector<glm::vec2>
        median_s_m;  // [m] where the marginal CDF over x is 1/2, and that column's over y
    /// Summed-area table as a sum of two floats: integral of C_m over x < edge i, y < edge j.
    std::vector<float> sat_hi, sat_lo;  // [m][h + 1][w + 1]
    std::vector<float>
        marginal_cdf;  // [m][w + 1] over x, 0 ... 1; all zero where the image is dark
    std::vector<float>
        conditional_cdf;         // [m][w][h + 1] over y within column i; all zero where it is dark
    std::vector<MipLevel> mips;  // levels 1, 2, ... down to 1 x 1
    /// The cells into which the supports of all Phi_m divide U: (W + n - 1) x (H + n - 1), row by
    /// row.
    glm::ivec2 cells{0};
    std::vector<glm::vec2>
        cell_reference_s_m;         // mean of median_s_m over the lit images that cover the cell
    std::vector<float> cell_total;  // sum of total over those images times Phi's share in the cell
};

/// A light field that is ready to render. `tables` has one entry a slab, or none (packed lean).
struct Luminaire {
    LightField lightfield;
    std::vector<SlabTables> tables;
};

/// Writes NAME.luminaire.exr (docs/formats.md), whole or not at all.
void write_luminaire(const Luminaire& luminaire,
                     const std::optional<RunRecord>& run,
                     const std::string& path);

/// Reads everything, tables included. To render, read_lightfield is the faster half (figures in
/// docs/formats.md).
Luminaire read_luminaire(const std::string& path);

}  // namespace nearfield
