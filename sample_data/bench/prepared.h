// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/bench/bench.h"
#include "sample_data/bench/places.h"

#include <vector>

namespace nearfield::sample_data {

/// Estimated error of the screen's irradiance: RMS over some points that the camera sees, all
/// positions, relative to the values' RMS. Zero for Setup::Direct.
struct OpticsError {
    double quadrature_rel = 0;  // change when the nodes on the lens are twice as dense
    double total_rel = 0;       // of the irradiance that pixels are made of, interpolation included
};

/// Pictures hold electrons per second, [row from the top][column], the pixel's own color.
struct PreparedBench {
    Bench bench;
    Places places;
    std::vector<std::vector<float>> positions;  // [position], lamp at its nominal light
    std::vector<float> open;                    // empty: not possible
    std::vector<float> blocked;                 // light that goes beside a plate on U
    std::vector<float> room;                    // room light on the screen; empty: none
    std::vector<float> flat;
    std::vector<std::vector<float>> targets;           // [view]
    std::vector<float> prnu, dark_e_per_s, offset_dn;  // fixed pattern; dark current at reference
    std::vector<double> photometer_lx;                 // [position]
    double photometer_open_lx = 0, photometer_blocked_lx = 0, photometer_room_lx = 0;
    OpticsError error;
};

}  // namespace nearfield::sample_data
