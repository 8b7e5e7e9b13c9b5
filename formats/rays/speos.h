// SPDX-License-Identifier: Apache-2.0
/// The header of Speos ray files (.ray), binary: the radiant flux (W), five floats, the luminous
/// flux (lm); then eight floats a ray: position in mm, direction, wavelength in nm, and what the
/// ray carries of the radiant flux, on any scale. There is no identifier and no count. Source:
/// files of that program, beside files of the same rays in other formats.
#pragma once

#include "formats/rays/byte_reader.h"
#include "formats/rays/ray_layout.h"

namespace nearfield::rays {

/// Whether size and content can be those of such a file: whole rows, a flux above 0, and a first
/// ray with a direction of unit length and a wavelength of 100 nm ... 100 um.
bool is_speos(ByteReader& file);
RayLayout read_speos_header(ByteReader& file);

}  // namespace nearfield::rays
