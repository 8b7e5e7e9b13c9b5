// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/passes.h"

#include "render/pass_plan.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace nearfield::render {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();
// A first pass towards an error.
constexpr int kFirstSamples = 16;
// Of the time that is left, what the first pass may plan for: its cost is known from trials alone.
constexpr double kFirstShare = 0.7;
// No tile of a later pass starts when so much of the time is over: it must end, and sums become
// means.
constexpr double kLastTile = 0.98;
// Trials render one tile of so many, and so many at least.
constexpr std::size_t kTilesPerTrialTile = 32, kFewestTrialTiles = 8;
// Two trials tell samples from the rest.
constexpr int kTrialSamples = 8, kMoreTrialSamples = 24;
// What a sum is coarsened to if an exact one takes too long.
constexpr int kCoarserQ[] = {32, 16, 8, 4, 2};
constexpr double kWorthwhile = 0.8;  // of the finer sum's time

/// A picture in the making.
struct Run {
    Frame& frame;
    const RenderHooks& hooks;
    double start_s = 0;
    std::vector<TileReport> reports;  // [tile]
    std::vector<TileWeight> weights;  // [tile]
    double drawn = 0;                 // samples of all passes; a mean over tiles
    Noise noise;
    double last_pass_s = 0;

    double elapsed_s() const { return hooks.clock_s() - start_s; }
    double left_s() const { return frame.options.time_s - elapsed_s(); }
};

template <typename Work>
void for_each(std::size_t count, const Work& work) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t t = range.begin(); t < range.end(); ++t)
                work(t);
        },
        tbb::simple_partitioner());
}

glm::ivec2 first_pixel(const Frame& frame, std::size_t tile) {
    const auto across = static_cast<std::size_t>(frame.tiles().x);
    return glm::ivec2(static_cast<int>(tile % across), static_cast<int>(tile / across)) * kTilePx;
}

/// Adds a pass. Tiles that would start after end_s are left as they are.
void render_pass(Run& run, const Pass& pass, double end_s) {
    const bool is_only = !(run.frame.options.error_rel > 0.0 || run.frame.options.time_s > 0.0);
    const double begin_s = run.hooks.clock_s();
    const auto tiles = static_cast<double>(run.reports.size());
    std::mutex mutex;
    double done = 0;
    for_each(run.reports.size(), [&](std::size_t tile) {
        if (end_s < kForever && run.hooks.clock_s() > end_s)
            return;
        render_tile(run.frame, pass, first_pixel(run.frame, tile), run.reports[tile]);
        run.weights[tile].add(pass);
        const std::lock_guard lock(mutex);
        ++done;
        if (run.hooks.progress)
            run.hooks.progress({is_only
                                    ? done / tiles
                                    : fraction_done(run.frame.options, run.noise, run.elapsed_s(),
                                                    run.drawn, pass.samples * done / tiles),
                                static_cast<int>(pass.index), run.noise.error_rel()});
    });
    run.drawn += pass.samples * done / tiles;
    run.last_pass_s = run.hooks.clock_s() - begin_s;
}

/// From the sums as they are: weights cancel in errors relative to light. Only a last pass leaves
/// tiles of different weights.
Noise noise_so_far(const Run& run) {
    const std::vector<Layer>& layers = run.frame.picture.layers;
    const float root = root_of_variance(run.frame.options, run.weights.front());
    Layer sigma = layers[kSigma];
    for (float& value : sigma.values)
        value = root * std::sqrt(value);
    return summarize_noise(layers[kRadiance], sigma,
                           run.frame.bias_layer ? &layers[*run.frame.bias_layer] : nullptr,
                           &layers[kDepth]);
}

/// The time of a whole pass, from some of its tiles spread over the frame.
double trial_s(Run& run, const Pass& pass) {
    const std::size_t tiles = run.reports.size();
    const std::size_t count =
        std::min(tiles, std::max(tiles / kTilesPerTrialTile, kFewestTrialTiles));
    const double begin_s = run.hooks.clock_s();
    for_each(count, [&](std::size_t k) {
        TileReport unused;
        render_tile(run.frame, pass, first_pixel(run.frame, (2 * k + 1) * tiles / (2 * count)),
                    unused);
    });
    return (run.hooks.clock_s() - begin_s) * static_cast<double>(tiles) /
           static_cast<double>(count);
}

/// Coarsens the pass' sum until one with few samples fits the time that is left, if that makes it
/// cheaper at all (where windows are small it does not). Returns the fixed cost.
double coarsen(Run& run, const PassCost& exact, Pass& pass) {
    PassCost cost = exact;
    for (const int q : kCoarserQ) {
        if (cost.of(kFewestSamples) <= kNextShare * run.left_s())
            break;
        Pass trial = pass;
        trial.samples = kTrialSamples;
        trial.q = q;
        const double fixed_s =
            std::max(trial_s(run, trial) - cost.per_sample_s * kTrialSamples, 0.0);
        if (fixed_s < kWorthwhile * cost.fixed_s) {
            cost.fixed_s = fixed_s;
            pass.q = q;
        }
    }
    return cost.fixed_s;
}

/// Samples, and Q where an exact sum would take too long, of the first pass within a time.
PassCost plan_first_pass(Run& run, int most, Pass& pass) {
    Pass trial = pass;
    trial.samples = kTrialSamples;
    const double time_s = trial_s(run, trial);
    trial.samples = kMoreTrialSamples;
    PassCost cost = cost_from(kTrialSamples, time_s, kMoreTrialSamples, trial_s(run, trial));
    if (!run.frame.options.sampler && pass.q == 0)
        cost.fixed_s = coarsen(run, cost, pass);
    pass.samples = std::max(samples_within(cost, kFirstShare * run.left_s()), kFewestSamples);
    pass.samples = std::min(pass.samples, most);
    for (Layer& layer : run.frame.picture.layers)
        std::fill(layer.values.begin(), layer.values.end(), 0.0F);
    return cost;
}

/// Of all tiles, in their order.
TileReport total_of(const std::vector<TileReport>& reports) {
    TileReport total;
    for (const TileReport& tile : reports) {
        total.camera_rays += tile.camera_rays;
        total.shadow_rays += tile.shadow_rays;
        total.sky_samples += tile.sky_samples;
        total.multiply_adds += tile.multiply_adds;
        total.camera_s += tile.camera_s;
        total.sums_s += tile.sums_s;
        total.shading_s += tile.shading_s;
        total.shadow_rays_s += tile.shadow_rays_s;
        total.gloss_s += tile.gloss_s;
        total.sky_s += tile.sky_s;
    }
    return total;
}

/// Counts, and time spent by all threads as shares of the wall time.
void fill_report(const TileReport& total, double wall_s, RenderReport& report) {
    report.camera_rays = total.camera_rays;
    report.shadow_rays = total.shadow_rays;
    report.sky_samples = total.sky_samples;
    report.multiply_adds = static_cast<double>(total.multiply_adds);
    const double spent_s = total.camera_s + total.sums_s + total.shading_s + total.sky_s;
    const double share = spent_s > 0.0 ? wall_s / spent_s : 0.0;
    report.camera_s = total.camera_s * share;
    report.sums_s = total.sums_s * share;
    report.visibility_s = total.shading_s * share;
    // What is left of shading without samples is adding up the sums.
    const double rest_s =
        std::max(total.shading_s - total.shadow_rays_s - total.gloss_s, 0.0) * share;
    const bool has_samples = has_pass(report.plan, PassId::Samples);
    const auto cost = [&](PassId id, double time_s) {
        if (has_pass(report.plan, id))
            report.costs.push_back({id, time_s, 0.0});
    };
    cost(PassId::CameraRays, report.camera_s);
    cost(PassId::LightSums, report.sums_s + (has_samples ? 0.0 : rest_s));
    cost(PassId::Samples, rest_s);
    cost(PassId::ShadowRays, total.shadow_rays_s * share);
    cost(PassId::Gloss, total.gloss_s * share);
    // One time for all that the sky gives: with the pass that takes most of it.
    cost(has_pass(report.plan, PassId::EnvironmentSamples) ? PassId::EnvironmentSamples
                                                           : PassId::EnvironmentIrradiance,
         total.sky_s * share);
}

}  // namespace

void render_passes(Frame& frame, const RenderHooks& hooks, double start_s, RenderReport& report) {
    const RenderOptions& options = frame.options;
    const auto tiles =
        static_cast<std::size_t>(frame.tiles().x) * static_cast<std::size_t>(frame.tiles().y);
    Run run{frame, hooks, start_s, std::vector<TileReport>(tiles), std::vector<TileWeight>(tiles),
            0.0,   {},    0.0};
    const bool has_goal = options.error_rel > 0.0 || options.time_s > 0.0;
    const int most = !frame.plan.draws_samples ? kFewestSamples
                     : options.samples > 0     ? options.samples
                     : has_goal                ? kMostSamples
                                               : kUsualSamples;
    Pass pass;
    pass.samples = has_goal ? std::min(kFirstSamples, most) : most;
    pass.q = options.q;
    PassCost cost;
    const double plan_start_s = now_s();
    if (options.time_s > 0.0)
        cost = plan_first_pass(run, most, pass);
    report.plan_s = now_s() - plan_start_s;
    if (pass.q > 0 && options.has_bias_bound)
        frame.bias_layer = add_bias_layer(frame.picture);

    const double passes_start_s = now_s();
    const int first_samples = pass.samples;
    while (pass.samples > 0) {
        pass.weight = static_cast<float>(pass.samples) / static_cast<float>(first_samples);
        render_pass(run, pass,
                    pass.index > 0 && options.time_s > 0.0 ? start_s + kLastTile * options.time_s
                                                           : kForever);
        run.noise = noise_so_far(run);
        pass.samples =
            has_goal ? next_samples(options, {static_cast<int>(run.drawn), most, run.noise, cost,
                                              pass.samples, run.last_pass_s, run.left_s()})
                     : 0;
        ++pass.index;
    }
    fill_report(total_of(run.reports), now_s() - passes_start_s, report);
    for_each(tiles, [&](std::size_t tile) {
        finish_tile(frame, first_pixel(frame, tile), run.weights[tile]);
    });
    report.passes = static_cast<int>(pass.index);
    report.samples = frame.plan.draws_samples ? run.drawn : 0.0;
    report.q = pass.q;
}

}  // namespace nearfield::render
