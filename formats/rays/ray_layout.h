// SPDX-License-Identifier: Apache-2.0
/// What stands behind the header of a ray file: rows of numbers, one a ray, and what they mean.
/// Formats differ in nothing else.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::rays {

struct SpectralTable {
    std::vector<float> wavelength_nm, weight;  // weight: radiant power per nm, any scale
};

struct RayLayout {
    std::string format;  // "IES TM-25", "Zemax (text)" ...
    bool is_text = false;
    std::uint64_t data_byte = 0;  // of the first row
    std::uint64_t ray_count = 0;  // 0: not known before the file's end

    /// A row of floats (in text: of numbers). Position and direction are columns 0 ... 5 in every
    /// format, what is not named here is skipped.
    std::size_t columns = 6;
    std::optional<std::size_t> radiant, wavelength, luminous, tristimulus_x, tristimulus_z,
        spectrum;  // index of a table, counted from 1

    double m_per_unit = 1e-3;  // of positions
    double nm_per_unit = 1;    // of wavelengths
    glm::dvec3 origin_m{0.0};  // added to positions
    bool has_wavelength_for_all = false;
    double wavelength_nm = 0;           // of all rays
    std::vector<SpectralTable> tables;  // by a ray's index, or one for all
    std::string end;                    // what follows the last row of text

    double luminous_flux_lm = 0, radiant_flux_w = 0;  // of all rays, as stated; NaN or 0: not
    std::vector<std::string> notes;
};

}  // namespace nearfield::rays
