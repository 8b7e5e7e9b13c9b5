// SPDX-License-Identifier: Apache-2.0
/// The report of a calibration, section by section.
#pragma once

#include "calibrate/geometry.h"
#include "formats/report/page.h"

#include <vector>

namespace nearfield::app {

/// The camera, how well it is known, the planes.
std::vector<report::Section> geometry_sections(const calibrate::Geometry& geometry);

}  // namespace nearfield::app
