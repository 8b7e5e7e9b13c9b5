// SPDX-License-Identifier: Apache-2.0
/// One estimator on one target: its error, its time, what it reads.
#pragma once

#include "app/bench/target.h"
#include "render/metrics.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::bench {

/// How the light at a receiver is computed.
struct Method {
    std::optional<model::SamplerOptions> sampling;  // none: the windowed sum
    int q = 0;                                      // of the sum; 0: exact
    model::Shift shift = model::Shift::Random;      // of sampling

    /// "systematic", ..., "sum".
    std::string name() const;
    /// K or Q; 0: exact.
    int size() const { return sampling ? sampling->samples : q; }
};

/// A method to be measured, and where it stands in the report.
struct Case {
    std::string sweep;    // "samplers", "search", ...
    std::string curve;    // within the sweep
    std::string setting;  // what is varied, as text
    Method method;
    int passes = 5;  // with independent shifts; errors are pooled over them
};

struct Result {
    Case of;
    render::RelativeError error;       // over receivers and passes
    double rms_low = 0, rms_high = 0;  // the smallest and largest of a pass
    /// RMS of the means over blocks of 4 x 4 receivers; none where they are scattered.
    std::optional<double> block_rms;
    double time_us = 0;  // wall time a receiver, all threads: the best pass
    double look_us = 0;  // of it, what comes before the first sample; 0 for the sum
    double reads = 0;    // of tables and texels, a receiver
};

/// Light at all receivers by one set of shifts, in parallel.
struct Pass {
    double time_s = 0;
    std::uint64_t reads = 0;
};
Pass run_pass(const Target& target,
              const Method& method,
              std::uint32_t pass,
              std::uint32_t seed,
              std::vector<float>& y);

/// Errors depend on the case and the seed alone. Times are of the passes, and of more passes like
/// the first where these were over too soon to be timed.
Result measure(const Target& target, const Case& a_case, std::uint32_t seed);

}  // namespace nearfield::bench
