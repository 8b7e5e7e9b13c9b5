// SPDX-License-Identifier: Apache-2.0
/// Where a low beam's light ends upwards, as headlights are judged.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace nearfield::app {

/// Illuminance facing the lamp, in a direction given by tangents.
using BeamScan = std::function<double(double tangent_x, double tangent_y)>;

/// The tangent at which log E falls fastest on the way upwards, over steps of 0.1 degrees, as ECE
/// R 112 defines the gradient, refined by a parabola. It moves upwards with blur, towards the dark.
/// None where there is no light.
std::optional<double> gradient_tangent(const BeamScan& scan, double tangent_x);

/// The tangent of the sharp edge that would leave as much light: below it the beam as it is from
/// 1.2 to 0.6 degrees under the edge, continued as an exponential, above it nothing. Blur that is
/// even to both sides moves it by a tenth of what it moves the gradient. None where there is no
/// light or no such edge.
std::optional<double> edge_tangent(const BeamScan& scan, double tangent_x);

/// Tangents along x at which the line is looked at: its level part and its rise, in the sample
/// headlight's beam.
std::vector<double> cutoff_places();

}  // namespace nearfield::app
