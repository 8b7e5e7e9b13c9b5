// SPDX-License-Identifier: Apache-2.0
/// A light field that is made rows of texels at a time and never is in memory as a whole.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/files/unnamed_file.h"

#include <span>

namespace nearfield {

/// Rows come in any order; they wait in an unnamed file, where images can be read back.
/// Memory  what is put or read; write(): an image or a few (exr_stream.h).
class LightFieldRows {
  public:
    /// `slab`: all but coefficients and sigma. Throws Error where its geometry breaks a rule of
    /// lightfield.h, or the folder cannot be written.
    LightFieldRows(const Slab& slab, bool has_sigma, const std::string& folder);

    /// Rows j = first_row ... of every image, [channel][m][j][i]; sigma empty where there is none.
    /// Throws Error where sizes do not fit, or a value is negative or not finite.
    void put(int first_row,
             int row_count,
             std::span<const float> coeffs,
             std::span<const float> sigma);

    /// An image's coefficients, [j][i]. Rows that were never put are zero.
    std::vector<float> image(int channel, int m) const;

    /// The file that write_lightfield makes of the whole; `about`: quantity, scale and provenance,
    /// no slab.
    void write(const LightField& about,
               const std::optional<RunRecord>& run,
               const std::string& path) const;

  private:
    enum class Table { Coeffs, Sigma };
    void put(Table table, int first_row, int row_count, std::span<const float> values);
    void read(Table table, std::size_t image, float* values) const;

    Slab slab_;
    bool has_sigma_;
    UnnamedFile file_;
};

}  // namespace nearfield
