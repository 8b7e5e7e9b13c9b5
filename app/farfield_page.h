// SPDX-License-Identifier: Apache-2.0
/// What `nearfield farfield` writes of a map.
#pragma once

#include "formats/farfield/near_far.h"
#include "formats/report/page.h"
#include "formats/report/plot.h"

#include <string>

namespace nearfield::app {

/// A line of the summary an error; `stand_in` is what errs: "a point".
std::string farfield_text(const farfield::NearFarMap& map, const std::string& stand_in);

/// h_deg,v_deg,intensity,sigma and the distance for each of its errors; empty where dark.
std::string farfield_csv(const farfield::NearFarMap& map, Quantity quantity);

/// The map of distances for errors[k].
report::HeatMap distance_map(const farfield::NearFarMap& map,
                             std::size_t k,
                             const std::string& stand_in);

report::Page farfield_page(const farfield::NearFarMap& map,
                           Quantity quantity,
                           const std::string& lamp,
                           const std::string& stand_in);

}  // namespace nearfield::app
