// SPDX-License-Identifier: Apache-2.0
/// The plots and maps of the page.
#pragma once

#include "app/bench/sweeps.h"
#include "formats/report/plot.h"

#include <string>

namespace nearfield::bench {

/// Of the sweep "samplers", a curve a sampler; the settings that none beats are marked.
report::Plot error_against_time(const Findings& findings);
/// Of the samplers that have a K.
report::Plot error_against_k(const Findings& findings);
/// The same, and the exact sum's time.
report::Plot time_against_k(const Findings& findings);
/// Error against time of a knob, a curve a curve.
report::Plot knob_plot(const Findings& findings, const std::string& sweep);

/// A picture of the wall as the lamp's observer sees it, and its error.
report::HeatMap light_map(const WallPictures& wall, const WallPicture& picture);
report::HeatMap error_map(const WallPictures& wall, const WallPicture& picture);

}  // namespace nearfield::bench
