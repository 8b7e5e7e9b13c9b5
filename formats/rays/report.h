// SPDX-License-Identifier: Apache-2.0
/// What a conversion says of itself: a text for the terminal, a Provenance for the file.
#pragma once

#include "formats/rays/ray_file.h"
#include "formats/rays/to_lightfield.h"

#include <optional>
#include <string>

namespace nearfield::rays {

/// Scales the rays to a total flux; a note says so. Throws Error unless flux is finite and > 0.
void scale_to(RaySet& set, double flux);

/// A few lines: rays, flux, what was dropped, each slab's planes and resolution and why, expected
/// error.
std::string summary(const RaySet& set, const ConvertReport& report);

/// Command, options with the values chosen, and figures; inputs are left to the caller.
Provenance describe(const RaySet& set,
                    const ReadOptions& read,
                    const ConvertOptions& options,
                    std::optional<double> flux,
                    const ConvertReport& report);

}  // namespace nearfield::rays
