// SPDX-License-Identifier: Apache-2.0
/// What `bench accuracy` measures: samplers against K and Q, and each knob's price.
#pragma once

#include "app/bench/measure.h"
#include "app/bench/wall_pictures.h"
#include "formats/files/lightfield.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nearfield::bench {

struct SweepOptions {
    std::vector<std::string> samplers;  // names; empty: all
    std::vector<std::string> sweeps;    // names; empty: all
    std::vector<int> k = {4, 16, 63, 200, 1000, 4000, 16000, 63000, 250000, 1000000};
    std::vector<int> q = {2, 3, 4, 6, 8, 12, 16, 24, 32};  // the exact sum comes always
    int repeats = 5;
    double time_limit_s = 600.0;
    int threads = 0;  // 0: all cores
    std::uint32_t seed = 1;
};

/// "sum" and the names of model::Sampler.
std::vector<std::string> sampler_names();
/// "samplers", the knobs ("search", "k-max", ...) and "pictures".
std::vector<std::string> sweep_names();

struct Findings {
    std::vector<Result> results;  // sweep by sweep, curve by curve, in order of rising K or Q
    WallPictures pictures;
    int skipped = 0;  // cases that the time limit left out
    int threads = 0;
    std::size_t receivers = 0;
    double time_s = 0;
};

/// Receivers are in the luminaire's frame. Costly cases come last; one that would end after the
/// time limit is left out, and counted. Throws Error where no light reaches any receiver.
Findings run_sweeps(const std::vector<Slab>& slabs,
                    const std::vector<model::Receiver>& receivers,
                    const SweepOptions& options,
                    const std::function<void(double fraction)>& progress);

/// The results of a sweep in order; curve empty: of all its curves.
std::vector<const Result*> results_of(const Findings& findings,
                                      const std::string& sweep,
                                      const std::string& curve = "");

/// The curves of a sweep in order.
std::vector<std::string> curves_of(const Findings& findings, const std::string& sweep);

}  // namespace nearfield::bench
