// SPDX-License-Identifier: Apache-2.0
#include "app/bench/sweeps.h"

#include "app/bench/cases.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "formats/model/profile.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace nearfield::bench {
namespace {

constexpr int kCostlySamples = 20000;  // cases with more come when all others are done
constexpr int kTexelLevels = 4;
constexpr int kWallWidth = 160, kLeastWallHeight = 40, kMostWallHeight = 160;

// A case, and what came of it unless there was no time.
struct Job {
    Case of;
    std::optional<Result> result;
};

struct Run {
    const SweepOptions& options;
    const std::function<void(double)>& progress;
    double start_s = 0, whole_weight = 0, done_weight = 0;
    std::map<std::string, double> s_per_weight;  // by the method's name, as measured
};

bool has_time_for(const Run& run, const Case& a_case) {
    const auto known = run.s_per_weight.find(a_case.method.name());
    const double expected_s =
        known == run.s_per_weight.end() ? 0.0 : known->second * weight(a_case);
    return now_s() - run.start_s + expected_s < run.options.time_limit_s;
}

void work(Run& run, const Target& target, Job& job) {
    run.progress(run.done_weight / run.whole_weight);
    if (has_time_for(run, job.of)) {
        job.result = measure(target, job.of, run.options.seed);
        const double passes_s =
            1e-6 * job.result->time_us * static_cast<double>(target.count()) * job.of.passes;
        run.s_per_weight[job.of.method.name()] = passes_s / weight(job.of);
    }
    run.done_weight += weight(job.of);
}

template <typename Takes>
void work_on(Run& run, const Target& target, std::vector<Job>& jobs, const Takes& takes) {
    for (Job& job : jobs)
        if (takes(job.of))
            work(run, target, job);
}

bool is_costly(const Case& a_case) {
    return a_case.method.size() > kCostlySamples;
}

bool is_of_other_lamp(const Case& a_case) {
    return a_case.sweep == "basis" || a_case.sweep == "texels";
}

// A lamp that is varied, and the name of what it was given.
struct Variant {
    std::string sweep, setting;
    std::vector<Slab> slabs;
};

std::vector<std::string> texel_settings(const std::vector<model::PreparedMips>& mips) {
    std::vector<std::string> settings;
    const std::vector<model::PreparedSlab>& levels = mips.front().levels;
    for (std::size_t l = 0; l < std::min<std::size_t>(kTexelLevels, levels.size()); ++l)
        settings.push_back(
            fmt::format("{} x {}", levels[l].slab.texels.x, levels[l].slab.texels.y));
    return settings;
}

Variant with_basis(const Lamp& lamp, const std::string& basis) {
    Variant variant{"basis", basis, {}};
    for (const model::SamplingSlab& slab : lamp.slabs) {
        variant.slabs.push_back(slab.prepared.slab);
        variant.slabs.back().profile = model::make_profile(basis);
    }
    return variant;
}

Variant with_texels(const Lamp& lamp, std::size_t level, const std::string& setting) {
    Variant variant{"texels", setting, {}};
    for (const model::PreparedMips& mips : lamp.mips)
        variant.slabs.push_back(mips.levels[std::min(level, mips.levels.size() - 1)].slab);
    return variant;
}

void work_on_variant(Run& run,
                     const Variant& variant,
                     const Target& original,
                     const std::vector<model::Receiver>& receivers,
                     std::vector<Job>& jobs) {
    const auto takes = [&](const Case& a_case) {
        return a_case.sweep == variant.sweep && a_case.setting == variant.setting;
    };
    if (std::none_of(jobs.begin(), jobs.end(), [&](const Job& job) { return takes(job.of); }))
        return;
    const Lamp lamp = make_lamp(variant.slabs);
    Target target = make_target(lamp, receivers);
    if (variant.sweep == "texels")
        target.truth_y = original.truth_y;
    work_on(run, target, jobs, takes);
}

std::vector<Job> make_jobs(const SweepOptions& options, const Lamp& lamp) {
    std::vector<Job> jobs;
    const auto add = [&](const std::vector<Case>& cases) {
        for (const Case& a_case : cases)
            if (is_chosen(options.sweeps, a_case.sweep))
                jobs.push_back({a_case, std::nullopt});
    };
    add(sampler_cases(options));
    for (const std::string& sweep : sweep_names())
        add(knob_cases(options, sweep));
    // Curve by curve: the settings of one estimator stand together.
    std::vector<Job> varied;
    std::swap(jobs, varied);
    for (const std::string& basis : model::profile_names())
        add(lamp_cases(options, "basis", basis));
    for (const std::string& texels : texel_settings(lamp.mips))
        add(lamp_cases(options, "texels", texels));
    std::stable_sort(jobs.begin(), jobs.end(), [](const Job& a, const Job& b) {
        return std::pair(a.of.sweep, a.of.curve) < std::pair(b.of.sweep, b.of.curve);
    });
    varied.insert(varied.end(), jobs.begin(), jobs.end());
    return varied;
}

// After the exact sum: a quick one, and all samplers.
std::vector<Method> picture_methods(const SweepOptions& options) {
    constexpr int kQuickQ = 12;
    std::vector<Method> methods = {{std::nullopt, kQuickQ, model::Shift::Random}};
    const std::vector<Method> samplers = chosen_samplers(options);
    methods.insert(methods.end(), samplers.begin(), samplers.end());
    return methods;
}

Wall default_wall(const std::vector<model::Receiver>& receivers) {
    Wall wall = wall_of(receivers, {kWallWidth, 0});
    const glm::dvec2 size_m = wall.upper_m - wall.lower_m;
    wall.size.y = std::clamp(static_cast<int>(kWallWidth * size_m.y / size_m.x), kLeastWallHeight,
                             kMostWallHeight);
    return wall;
}

// What needs receivers on a wall: shifts, and pictures.
void work_on_wall(Run& run,
                  const Lamp& lamp,
                  const std::vector<model::Receiver>& receivers,
                  std::vector<Job>& jobs,
                  Findings& findings) {
    const SweepOptions& options = run.options;
    const Wall wall = default_wall(receivers);
    const Target target = make_target(lamp, receivers_on(wall), wall.size);
    const bool is_lit =
        std::any_of(target.truth_y.begin(), target.truth_y.end(), [](float y) { return y > 0.0F; });
    if (!is_lit)
        return;
    work_on(run, target, jobs, [](const Case& a_case) { return a_case.sweep == "shift"; });
    if (is_chosen(options.sweeps, "pictures") && now_s() - run.start_s < options.time_limit_s)
        findings.pictures = draw_wall(target, wall, picture_methods(options), options.seed);
}

void work_on_all(Run& run,
                 const Lamp& lamp,
                 const Target& target,
                 const std::vector<model::Receiver>& receivers,
                 std::vector<Job>& jobs,
                 Findings& findings) {
    const auto is_of_target = [](const Case& a_case) {
        return a_case.sweep != "shift" && !is_of_other_lamp(a_case);
    };
    work_on(run, target, jobs,
            [&](const Case& a_case) { return is_of_target(a_case) && !is_costly(a_case); });
    work_on_wall(run, lamp, receivers, jobs, findings);
    for (const std::string& basis : model::profile_names())
        work_on_variant(run, with_basis(lamp, basis), target, receivers, jobs);
    const std::vector<std::string> settings = texel_settings(lamp.mips);
    for (std::size_t level = 0; level < settings.size(); ++level)
        work_on_variant(run, with_texels(lamp, level, settings[level]), target, receivers, jobs);
    work_on(run, target, jobs,
            [&](const Case& a_case) { return is_of_target(a_case) && is_costly(a_case); });
}

}  // namespace

Findings run_sweeps(const std::vector<Slab>& slabs,
                    const std::vector<model::Receiver>& receivers,
                    const SweepOptions& options,
                    const std::function<void(double fraction)>& progress) {
    const int threads = options.threads == 0 ? tbb::info::default_concurrency() : options.threads;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    Run run{options, progress, now_s(), 0.0, 0.0, {}};
    const Lamp lamp = make_lamp(slabs);
    const Target target = make_target(lamp, receivers);
    if (std::none_of(target.truth_y.begin(), target.truth_y.end(),
                     [](float y) { return y > 0.0F; }))
        throw Error{"nothing to measure", "receivers", "light at one of them at least",
                    fmt::format("none at {}", receivers.size())};

    std::vector<Job> jobs = make_jobs(options, lamp);
    for (const Job& job : jobs)
        run.whole_weight += weight(job.of);
    Findings findings;
    work_on_all(run, lamp, target, receivers, jobs, findings);
    for (Job& job : jobs) {
        if (job.result)
            findings.results.push_back(std::move(*job.result));
        else
            ++findings.skipped;
    }
    findings.threads = threads;
    findings.receivers = receivers.size();
    findings.time_s = now_s() - run.start_s;
    return findings;
}

std::vector<const Result*> results_of(const Findings& findings,
                                      const std::string& sweep,
                                      const std::string& curve) {
    std::vector<const Result*> found;
    for (const Result& result : findings.results)
        if (result.of.sweep == sweep && (curve.empty() || result.of.curve == curve))
            found.push_back(&result);
    return found;
}

std::vector<std::string> curves_of(const Findings& findings, const std::string& sweep) {
    std::vector<std::string> curves;
    for (const Result* result : results_of(findings, sweep))
        if (std::find(curves.begin(), curves.end(), result->of.curve) == curves.end())
            curves.push_back(result->of.curve);
    return curves;
}

}  // namespace nearfield::bench
