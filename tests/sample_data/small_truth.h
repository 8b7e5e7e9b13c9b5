// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/simulate.h"

#include <nlohmann/json.hpp>

namespace nearfield::support {

/// The options that the committed sample headlight_small.lightfield.exr was made with.
sample_data::SimulateOptions small_options();

/// What the small sample must give, in its own frame: irradiance at 50 points, intensity in 12
/// directions and flux, each by quadrature of the headlight's formula and by brute force from the
/// light field (tests/support/oracle.h).
nlohmann::ordered_json small_truth(const sample_data::Headlight& headlight,
                                   const LightField& lightfield);

}  // namespace nearfield::support
