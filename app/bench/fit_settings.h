// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield::bench {

/// One measurement and its fit.
struct FitSetting {
    std::string sweep;    // "positions", "exposures", "frames", "filter", ...
    std::string setting;  // what is varied, as text with unit
    double value = 0;     // the same as a number; of bases 0
    glm::ivec2 grid{11, 9};
    double missing_share = 0;  // of positions
    double delta_m = 0.2;
    double filter_width = 1;  // the filter's pitch over the stage's steps
    std::string basis = "bspline";
    int exposures = 3;              // each four times as long as the one before
    int frames = 1;                 // of each exposure, averaged
    double model_error_rel = 3e-2;  // of a texel's brightest position, in every measurement's sigma
    std::optional<double> lambda;   // smoothness; none: by cross-validation
};

/// Sweep by sweep, each in order; quick: two of each.
std::vector<FitSetting> fit_settings(bool quick);

}  // namespace nearfield::bench
