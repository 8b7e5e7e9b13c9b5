// SPDX-License-Identifier: Apache-2.0
/// EULUMDAT (.ldt), the European photometric file: a value a line. Source: Stockmar, "EULUMDAT -
/// ein Leuchtendatenformat fuer den europaeischen Beleuchtungsplaner", Licht '90, 1990.
#pragma once

#include "formats/photometry/photometry.h"
#include "formats/photometry/text_file.h"

namespace nearfield::photometry {

/// Whether lines 2 ... 4 and 6 are the type, the symmetry and the counts of planes and angles.
bool is_eulumdat(const TextFile& file);

/// The table is scaled to the lamps of set `lamp_set`: such files hold candela for 1000 lm.
/// Throws Error with line, expected and got where the file is not as described.
Photometry read_eulumdat(const TextFile& file, int lamp_set);

/// The file's text; symmetries that are exact are used.
/// Throws Error where the photometry is none (check), not of type C, has neither light nor lamps to
/// refer to, or C0 and C360 differ.
std::string to_eulumdat(const Photometry& photometry);

}  // namespace nearfield::photometry
