// SPDX-License-Identifier: Apache-2.0
/// What the measurements mean: time to an error for each sampler, and against the baselines.
#pragma once

#include "app/bench/arrival.h"
#include "app/bench/sweeps.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::bench {

/// The errors (relative RMS) that the summary asks about.
constexpr std::array<double, 2> kGoals_rel = {0.1, 0.01};
/// The samplers that others are compared with.
constexpr std::array<const char*, 2> kBaselines = {"pdis", "uniform"};

/// How many times faster one sampler is than a baseline.
struct Speedup {
    std::string baseline;
    /// By time to the goal; where the baseline never arrives, at least this, by the time after
    /// which it was given up. Empty where this sampler never arrives.
    std::optional<double> ratio;
    bool baseline_arrives = false;
};

struct SamplerSummary {
    std::string sampler;
    std::array<std::optional<CostPoint>, 2> arrivals;  // [goal]
    std::array<std::vector<Speedup>, 2> speedups;      // [goal][baseline]
    CostPoint end;  // the last of its points: the largest K, or the exact sum
};

std::vector<CostPoint> points_of(const std::vector<const Result*>& results);

/// One entry for each curve of the sweep "samplers".
std::vector<SamplerSummary> summarize(const Findings& findings);

/// For each result of the sweep "samplers", whether none other is better in error and time.
std::vector<bool> on_front(const Findings& findings);

/// The same in words, a sentence for each goal.
std::vector<std::string> sentences(const std::vector<SamplerSummary>& summaries);

/// "12 us", "3.4 ms".
std::string time_text(double time_us);
/// "0.13 %".
std::string percent_text(double share);

}  // namespace nearfield::bench
