// SPDX-License-Identifier: Apache-2.0
/// The report of a calibration.
#pragma once

#include "calibrate/calibrate.h"
#include "formats/report/page.h"
#include "formats/report/plot.h"

#include <optional>
#include <string>
#include <vector>

namespace nearfield::app {

/// The two planes, everything drawn in the slab's frame, the stage's errors.
report::Section planes_section(const calibrate::Geometry& geometry,
                               const calibrate::PlanesResult& result);

/// The camera, how well it is known, the planes, the parameters.
std::vector<report::Section> geometry_sections(const calibrate::Geometry& geometry);

/// The sensor, its response, the lens' light, the filter, the scale.
std::vector<report::Section> radiometry_sections(const calibrate::RadiometryResult& radiometry);

/// All of it, with flags first.
report::Page calibration_page(const calibrate::Calibration& calibration,
                              const std::string& command);

/// Adds a drawing, or once a section a sentence that says why it is missing.
void add_drawing(report::Section& section, const std::optional<report::Image>& image);

/// Names, values and sigmas.
report::Table parameter_table(const std::vector<rig::Parameter>& parameters);

}  // namespace nearfield::app
