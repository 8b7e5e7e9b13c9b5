// SPDX-License-Identifier: Apache-2.0
/// `nearfield convert` of photometric files.
#pragma once

#include "app/output.h"
#include "formats/photometry/photometry.h"

#include <optional>
#include <string>
#include <vector>

namespace nearfield::app {

/// Options of its own; slabs, grid, texels and flux are shared with ray files.
struct PhotometryOptions {
    std::vector<double> opening_mm;  // none or two
    std::optional<double> half_angle_deg, depth_sides;
    std::optional<int> lamp_set;
};

struct ConvertCommand;

/// Reads, converts, reports and writes. Exit code 3 where over 2 % of the flux is lost.
void convert_photometry(ConvertCommand& command);

}  // namespace nearfield::app
