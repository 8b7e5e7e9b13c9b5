// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/photometry/photometry.h"

#include <optional>

namespace nearfield::photometry {

/// The opening that LM-63 encodes in the signs of three lengths; nothing for what no edition of the
/// standard has. `year` is the edition's, which decides where editions differ; width lies across
/// the plane of 0 degrees, length along it.
std::optional<Opening> opening_of_signs(int year, double width_m, double length_m, double height_m);

/// The signed width, length and height of an opening, after the table of 2002. Length is x here.
glm::dvec3 signs_of_opening(const Opening& opening);

}  // namespace nearfield::photometry
