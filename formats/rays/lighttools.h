// SPDX-License-Identifier: Apache-2.0
/// The headers of LightTools ray data files (.ray), binary ("LTRF") and text ("lt_startofdata").
/// Sources: LightTools' help, "Ray data file", as free readers quote it, and files of that program.
/// Seven floats a ray, or eight with a wavelength in nm; "LTRFEND" or "lt_endofdata" behind the
/// last one; no count.
#pragma once

#include "formats/rays/byte_reader.h"
#include "formats/rays/ray_layout.h"

#include <string_view>

namespace nearfield::rays {

constexpr std::string_view kLightToolsMagic = "LTRF", kLightToolsEnd = "LTRFEND",
                           kLightToolsTextStart = "lt_startofdata",
                           kLightToolsTextEnd = "lt_endofdata";

bool is_lighttools_binary(ByteReader& file);
bool is_lighttools_text(ByteReader& file);

/// Throws Error naming byte offset (and ray) where the header is not as described, the end is
/// missing, or rays have no position, have polarization or tristimulus values (no such file is
/// known here).
RayLayout read_lighttools_header(ByteReader& file);
RayLayout read_lighttools_text_header(ByteReader& file);

}  // namespace nearfield::rays
