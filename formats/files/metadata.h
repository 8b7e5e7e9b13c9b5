// SPDX-License-Identifier: Apache-2.0
/// The JSON texts in the string attributes of our EXR files (docs/formats.md).
#pragma once

#include "formats/files/exr_file.h"
#include "formats/files/lightfield.h"
#include "formats/files/provenance.h"

#include <optional>
#include <string>

namespace nearfield {

inline const std::string kLuminaireAttribute = "nearfield.luminaire";
inline const std::string kProvenanceAttribute = "nearfield.provenance";
inline const std::string kRunAttribute = "nearfield.run";

/// Everything of a light field but its coefficients and provenance, as text.
std::string describe(const LightField& lightfield, const FileKind& kind, bool has_tables);

/// What describe() wrote: geometry, channels; arrays empty.
struct Description {
    FileKind kind;
    LightField lightfield;
    std::vector<bool> has_sigma;               // a slab
    std::vector<std::size_t> replicate_count;  // a slab
    bool has_tables = false;
};

/// Kind and format version alone. Throws Error where the text is not ours or is newer than this
/// program.
FileKind parse_kind(const std::string& text, const std::string& where);

/// All of it; the geometry is checked.
Description parse_description(const std::string& text, const std::string& where);

/// Throws Error where a slab's geometry (all but coeffs and sigma) breaks a rule of lightfield.h.
void check_geometry(const Slab& slab, const std::string& where);

/// The provenance and run attributes of any file that we write.
exr::Attributes provenance_attributes(const Provenance& provenance,
                                      const std::optional<RunRecord>& run);

/// Reads them back; empty where the file has none.
Provenance read_provenance(const exr::Reader& reader, const std::string& path);
std::optional<RunRecord> read_run(const exr::Reader& reader, const std::string& path);

}  // namespace nearfield
