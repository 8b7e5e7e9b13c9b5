// SPDX-License-Identifier: Apache-2.0
/// What a light field of the headlight gets wrong on a wall: its representation error.
#pragma once

#include "formats/files/lightfield.h"
#include "sample_data/headlight.h"

#include <vector>

namespace nearfield::sample_data {

/// A point of a wall that faces the lamp, with what the formula and what the light field say.
struct WallPoint {
    glm::dvec2 at_m{0.0};  // x, y in the luminaire's frame
    double truth_lx = 0, lightfield_lx = 0;
};

/// Relative errors are over points that receive more than 1e-3 of the brightest.
struct WallError {
    double distance_m = 0;  // of the wall from the lens
    double rms_rel = 0, median_rel = 0, p95_rel = 0, max_rel = 0;
    double bias_rel = 0;     // mean of E / truth - 1
    double max_of_peak = 0;  // largest difference anywhere, relative to the brightest point
    double peak_lx = 0;
};

/// A columns x rows grid of points that covers the beam on a wall at a distance from the lens, row
/// by row. Sums and quadrature alike are without shadows. Parallel over points.
std::vector<WallPoint> wall_points(const Headlight& headlight,
                                   const LightField& lightfield,
                                   double distance_m,
                                   glm::ivec2 points);

/// Points of a vertical line at x = tangent_x * distance, from bottom to top, over the height of
/// the beam.
std::vector<WallPoint> wall_profile(const Headlight& headlight,
                                    const LightField& lightfield,
                                    double distance_m,
                                    double tangent_x,
                                    int points);

WallError wall_error(const std::vector<WallPoint>& points, double distance_m);

}  // namespace nearfield::sample_data
