// SPDX-License-Identifier: Apache-2.0
/// `nearfield export` to photometric files.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/photometry/photometric_file.h"

#include <optional>
#include <string>

namespace nearfield::app {

struct PhotometryExport {
    photometry::FileFormat format = photometry::FileFormat::Lm63;
    std::optional<int> planes, quarter_angles;  // by default as fine as the flux asks for
};

/// Writes the far field of a light field, or another photometric file's table; says the flux in and
/// out. Exit code 3 where they differ by more than 0.1 %: the table is too coarse.
void export_photometry(const std::string& input,
                       const std::string& output,
                       const PhotometryExport& options);

/// The far field as a table of LM-63, labels and all, as fine as `options` or the flux asks for.
photometry::Photometry far_field_table(const LightField& lightfield,
                                       const std::string& input,
                                       const PhotometryExport& options);

}  // namespace nearfield::app
