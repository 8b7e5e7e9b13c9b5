// SPDX-License-Identifier: Apache-2.0
/// Small ray files of other programs' formats, byte by byte, that tests make for themselves.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace nearfield::test {

using Rows = std::vector<std::vector<float>>;  // one a ray

struct ZemaxFile {
    std::int32_t identifier = 1010, unit = 4, ray_format = 0, flux_type = 0;
    std::uint32_t ray_count = 0;
    float source_flux = 0, wavelength_um = 0;
    Rows rows;
};
std::string to_bytes(const ZemaxFile& file);

struct LightToolsFile {
    std::uint32_t version = 2, is_luminous = 1, far_field = 0, color = 0, unit = 1;
    std::vector<float> origin = {0, 0, 0};
    float flux = 0;
    Rows rows;
    std::string end = "LTRFEND";
};
std::string to_bytes(const LightToolsFile& file);

struct SpeosFile {
    float radiant_flux_w = 1, luminous_flux_lm = 0;
    Rows rows;  // position, direction, wavelength in nm, share
};
std::string to_bytes(const SpeosFile& file);

/// Three rays of 1, 2 and 3: position, unit direction, flux.
Rows three_rows();

}  // namespace nearfield::test
