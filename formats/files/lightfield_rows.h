// SPDX-License-Identifier: Apache-2.0
/// A light field that is made rows of texels at a time and never is in memory as a whole.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/files/unnamed_file.h"

#include <span>

namespace nearfield {

/// What a light field keeps of an image besides its coefficients.
struct LightFieldTables {
    bool has_sigma = false;
    int replicates = 0;
};

/// Rows come in any order; they wait in an unnamed file, where images can be read back.
/// Memory  what is put or read; write(): an image or a few (exr_stream.h).
class LightFieldRows {
  public:
    /// `slab`: all but coefficients, sigma and replicates. Throws Error where its geometry breaks a
    /// rule of lightfield.h, or the folder cannot be written.
    LightFieldRows(const Slab& slab, LightFieldTables tables, const std::string& folder);

    /// Rows j = first_row ... of every image, [channel][m][j][i]; sigma empty where there is none,
    /// infinite where nothing was seen: read as the brightest coefficient of all.
    /// Throws Error where sizes do not fit, or a value is negative or not finite.
    void put(int first_row,
             int row_count,
             std::span<const float> coeffs,
             std::span<const float> sigma);
    void put_replicate(int replicate, int first_row, int row_count, std::span<const float> coeffs);

    /// Image m alone: a slab of one basis function, with sigma and replicates. A light field's sums
    /// are those of its images. Rows that were never put are zero.
    Slab image(int m) const;

    /// The file that write_lightfield makes of the whole; `about`: quantity, scale and provenance,
    /// no slab.
    void write(const LightField& about,
               const std::optional<RunRecord>& run,
               const std::string& path) const;

  private:
    // 0: coefficients; then sigma, if there is one; then replicates.
    void put_table(
        int table, int first_row, int row_count, std::span<const float> values, float largest);
    void read(int table, int channel, int m, float* values) const;
    int first_replicate() const { return tables_.has_sigma ? 2 : 1; }
    int table_count() const { return first_replicate() + tables_.replicates; }

    Slab slab_;
    LightFieldTables tables_;
    float brightest_ = 0;
    UnnamedFile file_;
};

}  // namespace nearfield
