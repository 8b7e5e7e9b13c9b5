// SPDX-License-Identifier: Apache-2.0
/// Reads ray files. Source: IES TM-25-13, "Ray file format for the description of the emission
/// property of light sources", section 4.7. Lengths in the file are mm; everything is
/// little-endian.
#pragma once

#include "formats/rays/ray_set.h"

#include <functional>
#include <string>

namespace nearfield::rays {

struct ReadOptions {
    /// Keep the sum of the rays' flux even where the header states another total.
    bool keep_ray_flux = false;
    /// Keep radiant flux as it is. By default it becomes luminous flux where the file gives
    /// wavelengths or spectra.
    bool keep_radiometric = false;
    std::function<void(double fraction)> progress;
};

/// Reads a TM-25 ray file.
///
/// Out     rays whose flux is scaled to the header's total where it states one; notes say so.
/// Throws  Error naming byte offset and ray where the file is truncated, has another version, holds
/// a number that is
///         not finite, a direction of no length, negative flux, or counts that its size does not
///         justify; and, by name, for the formats of LightTools, Zemax and Speos, which are not
///         read.
/// Cost    one pass; 28 bytes of memory a ray (40 with color of its own).
RaySet read_tm25(const std::string& path, const ReadOptions& options = {});

}  // namespace nearfield::rays
