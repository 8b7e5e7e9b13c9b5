// SPDX-License-Identifier: Apache-2.0
/// What `nearfield info` says of ray files and photometric files.
#pragma once

#include "formats/photometry/photometry.h"
#include "formats/rays/survey.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace nearfield::app {

/// kind "ray file": format, quantity, rays, flux {of_rays, stated, backward, unit}, start_mm,
/// focus_mm, notes.
nlohmann::ordered_json describe(const rays::RaySurvey& survey);

/// kind "photometry": format, type, planes, angles, flux_lm, peak, opening, lamps, labels, notes.
nlohmann::ordered_json describe(const photometry::Photometry& photometry);

/// The same for people.
std::string rays_text(const rays::RaySurvey& survey);
std::string photometry_text(const photometry::Photometry& photometry);

}  // namespace nearfield::app
