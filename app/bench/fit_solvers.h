// SPDX-License-Identifier: Apache-2.0
/// The fit's solver beside general non-negative least squares, on the same texels in one run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace nearfield::bench {

struct SolverTime {
    std::string name;         // "banded", "dense, updated QR", "dense, fresh QR"
    double texel_us = 0;      // of a core
    double times_ours = 0;    // how many times slower than the first
    double difference = 0;    // largest, of coefficients, over the texel's largest
    std::int64_t texels = 0;  // times channels
};

/// Of a whole lamp's fit: all texels, all channels, all cores.
struct SolveCost {
    int texels = 0;  // along an axis
    int channels = 0;
    int threads = 0;
    double wall_s = 0, cpu_s = 0;
    double texel_us = 0;                               // of a core
    double factorizations = 0, free_coefficients = 0;  // a texel
    double kkt_worst = 0;
};

struct SolverComparison {
    std::vector<SolverTime> solvers;
    /// With the filter on U (one G for all texels) and off it by half a millimetre (a G for each),
    /// without and with sigmas.
    struct Whole {
        std::string name;
        SolveCost cost;
    };
    std::vector<Whole> wholes;
};

/// The reference lamp (11 x 9 images, B-splines), measured behind a filter with the noise of a
/// camera whose brightest datum has 1e6 electrons; no smoothing.
/// In      texels: along an axis, for the whole lamp's fit
///         compared: of them are solved by all solvers
SolverComparison compare_solvers(int texels, int compared);

}  // namespace nearfield::bench
