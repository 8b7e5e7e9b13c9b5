// SPDX-License-Identifier: Apache-2.0
#include "app/bench/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nearfield::bench {
namespace {

const SamplerSummary* find(const std::vector<SamplerSummary>& summaries, const std::string& name) {
    const auto found = std::find_if(summaries.begin(), summaries.end(),
                                    [&](const SamplerSummary& s) { return s.sampler == name; });
    return found == summaries.end() ? nullptr : &*found;
}

Speedup compare(const SamplerSummary& sampler, const SamplerSummary& baseline, std::size_t goal) {
    Speedup speedup{baseline.sampler, std::nullopt, baseline.arrivals[goal].has_value()};
    if (sampler.arrivals[goal]) {
        const double baseline_us =
            speedup.baseline_arrives ? baseline.arrivals[goal]->time_us : baseline.end.time_us;
        speedup.ratio = baseline_us / sampler.arrivals[goal]->time_us;
    }
    return speedup;
}

std::string comparison(const Speedup& speedup, const SamplerSummary& baseline) {
    if (speedup.baseline_arrives)
        return fmt::format("{:.3g} times as fast as {}", *speedup.ratio, speedup.baseline);
    return fmt::format("{} never gets there (it ends at {} after {}, {:.3g} times as long)",
                       speedup.baseline, percent_text(baseline.end.error_rel),
                       time_text(baseline.end.time_us), *speedup.ratio);
}

}  // namespace

std::string time_text(double time_us) {
    return time_us < 1e3   ? fmt::format("{:.3g} us", time_us)
           : time_us < 1e6 ? fmt::format("{:.3g} ms", 1e-3 * time_us)
                           : fmt::format("{:.3g} s", 1e-6 * time_us);
}

std::string percent_text(double share) {
    const double percent = 100.0 * share, size = std::abs(percent);
    return size >= 99.5                ? fmt::format("{:.0f} %", percent)
           : size == 0 || size >= 1e-4 ? fmt::format("{:.2g} %", percent)
                                       : "< 0.0001 %";
}

std::vector<CostPoint> points_of(const std::vector<const Result*>& results) {
    std::vector<CostPoint> points;
    points.reserve(results.size());
    for (const Result* result : results)
        points.push_back(
            {result->error.rms, result->time_us, static_cast<double>(result->of.method.size())});
    return points;
}

std::vector<SamplerSummary> summarize(const Findings& findings) {
    std::vector<SamplerSummary> summaries;
    for (const std::string& curve : curves_of(findings, "samplers")) {
        const std::vector<CostPoint> points = points_of(results_of(findings, "samplers", curve));
        SamplerSummary summary{curve, {}, {}, points.back()};
        for (std::size_t goal = 0; goal < kGoals_rel.size(); ++goal)
            summary.arrivals[goal] = arrival(points, kGoals_rel[goal]);
        summaries.push_back(summary);
    }
    for (SamplerSummary& summary : summaries)
        for (std::size_t goal = 0; goal < kGoals_rel.size(); ++goal)
            for (const char* name : kBaselines)
                if (const SamplerSummary* baseline = find(summaries, name))
                    summary.speedups[goal].push_back(compare(summary, *baseline, goal));
    return summaries;
}

std::vector<bool> on_front(const Findings& findings) {
    return pareto_front(points_of(results_of(findings, "samplers")));
}

std::vector<std::string> sentences(const std::vector<SamplerSummary>& summaries) {
    std::vector<std::string> texts;
    for (std::size_t goal = 0; goal < kGoals_rel.size(); ++goal) {
        const SamplerSummary* best = nullptr;
        for (const SamplerSummary& summary : summaries)
            if (summary.arrivals[goal] && (best == nullptr || summary.arrivals[goal]->time_us <
                                                                  best->arrivals[goal]->time_us))
                best = &summary;
        const std::string error = percent_text(kGoals_rel[goal]);
        if (best == nullptr) {
            texts.push_back(fmt::format("No sampler gets to an error of {}.", error));
            continue;
        }
        std::string text = fmt::format("To an error of {}, {} is the fastest: {} a point", error,
                                       best->sampler, time_text(best->arrivals[goal]->time_us));
        for (const Speedup& speedup : best->speedups[goal])
            if (speedup.baseline != best->sampler)
                text += "; " + comparison(speedup, *find(summaries, speedup.baseline));
        texts.push_back(text + ".");
    }
    return texts;
}

}  // namespace nearfield::bench
