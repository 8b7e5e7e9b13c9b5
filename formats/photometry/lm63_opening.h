// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/photometry/photometry.h"

#include <optional>

namespace nearfield::photometry {

/// The opening that LM-63 encodes in the signs of three lengths; nothing where an edition of the
/// standard gives the combination no meaning. `year` is the edition's; width lies across the plane
/// of 0 degrees, length along it. 1986 and 1991 share a table, so do 2002 and 2019.
std::optional<Opening> opening_of_signs(int year, double width_m, double length_m, double height_m);

/// The signed width, length and height of an opening, after the table of 2002. Length is x here.
glm::dvec3 signs_of_opening(const Opening& opening);

}  // namespace nearfield::photometry
