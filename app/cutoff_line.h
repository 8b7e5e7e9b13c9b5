// SPDX-License-Identifier: Apache-2.0
/// Where a low beam's light ends upwards, as headlights are judged.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace nearfield::app {

/// Illuminance facing the lamp, in a direction given by tangents.
using BeamScan = std::function<double(double tangent_x, double tangent_y)>;

/// The tangent at which the light falls fastest on the way upwards: the largest slope of log E over
/// steps of 0.1 degrees, as regulations define the cut-off, refined by a parabola. None where
/// there is no light.
std::optional<double> cutoff_tangent(const BeamScan& scan, double tangent_x);

/// Tangents along x at which the line is looked at: its level part and its rise, in the sample
/// headlight's beam.
std::vector<double> cutoff_places();

}  // namespace nearfield::app
