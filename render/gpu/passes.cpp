// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/passes.h"

#include "render/film.h"
#include "render/gpu/frame_report.h"
#include "render/pass_plan.h"

#include <algorithm>

namespace nearfield::render::gpu {
namespace {

// Towards an error, and within a time, of which nothing is known before the first pass.
constexpr int kFirstSamples = 16, kFirstSamplesInTime = kFewestSamples;
// A pass cannot be cut short: it draws at most so many times what has been drawn.
constexpr int kMostGrowth = 3;

/// Passes of one picture.
struct Run {
    GlFrame& frame;
    const Call& call;
    Picture& picture;
    RenderReport& report;
    int first_samples = 0;  // of the first pass,
    double first_s = 0;     // and what it took
    int drawn = 0;          // samples of a pixel and lamp, all passes
    int samples = 0;        // of the last pass
    double pass_s = 0;
    std::uint32_t first_set = 0, camera_sample = 0;
};

std::uint32_t sets_of_lamps(const Run& run) {
    return static_cast<std::uint32_t>(run.frame.opening.lamps.lamps.size()) *
           static_cast<std::uint32_t>(kMostSets);
}

void report_progress(const Run& run, double share_of_pass, bool has_goal) {
    if (!run.call.hooks.progress)
        return;
    const double fraction =
        has_goal ? fraction_done(run.frame.options, run.report.sampling, run.call.elapsed_s(),
                                 run.drawn, run.samples * share_of_pass)
                 : share_of_pass;
    run.call.hooks.progress({fraction, run.report.passes, run.report.sampling.error_rel()});
}

/// The light of what the camera sees that maps do not cover, asked for once: cameras do not move.
void find_unmapped(Run& run, const SampleQuery& query) {
    GlFrame& frame = run.frame;
    if (!has_pass(frame.plan, PassId::ShadowMaps) || frame.only_lamp)
        return;
    frame.device.run_pass("shadow maps", [&] {
        for (std::size_t k = 0; k < frame.opening.lamps.lamps.size(); ++k)
            if (frame.plan.lamps[k].is_lit)
                run.report.unmapped_pixels += count_unmapped(
                    frame.device, frame.surfaces.surfaces, frame.scene_buffers.materials,
                    frame.on_card, {frame.opening.lamps, k, frame.plan, frame.options, query},
                    frame.passes);
    });
}

Noise noise_of(const Run& run, const SampleQuery& query) {
    const Film& film = run.frame.film;
    // Passes of unequal weight count as so many of equal ones.
    const double passes = static_cast<double>(film.weight) * static_cast<double>(film.weight) /
                          static_cast<double>(film.weight_squares);
    const double degrees = (query.sets.sets - 1) * passes;
    read_film(film, static_cast<float>(degrees > 0.0 ? unbiased_root(degrees) : 1.0), run.picture);
    if (run.frame.sky != nullptr)
        read_depth(run.frame.surfaces.surfaces, run.picture);
    const std::vector<Layer>& layers = run.picture.layers;
    return summarize_noise(layers[kRadiance], layers[kSigma], film.bias ? &layers.back() : nullptr,
                           run.frame.sky != nullptr ? &layers[kDepth] : nullptr);
}

void add_whole_pass(Run& run, bool has_goal) {
    const double start_s = run.call.hooks.clock_s();
    const RenderOptions& options = run.frame.options;
    const int strata = strata_per_side(options.samples_per_pixel);
    SampleQuery query;
    query.size_px = run.picture.size_px;
    query.sets = sets_of(options, run.samples);
    query.seed = options.seed;
    const float weight = static_cast<float>(run.samples) / static_cast<float>(run.first_samples);
    for (int stratum = 0; stratum < strata * strata; ++stratum) {
        const glm::dvec2 at_px =
            (glm::dvec2(stratum % strata, stratum / strata) + 0.5) / static_cast<double>(strata);
        query.first_set = run.first_set;
        add_pass(run.frame, at_px, query, run.camera_sample, weight);
        run.first_set += sets_of_lamps(run);
        ++run.camera_sample;
        if (run.report.passes == 0 && stratum == strata * strata / 2)
            find_unmapped(run, query);
        report_progress(run, (stratum + 1.0) / (strata * strata), has_goal);
    }
    ++run.report.passes;
    run.drawn += run.samples;
    run.report.sampling = noise_of(run, query);
    run.pass_s = run.call.hooks.clock_s() - start_s;
}

/// Of passes over the picture, from the first and the last one.
render::PassCost cost_of(const Run& run) {
    if (run.samples == run.first_samples)
        return {0.0, run.pass_s / run.samples};
    return cost_from(run.first_samples, run.first_s, run.samples, run.pass_s);
}

}  // namespace

void draw_shadow_maps(GlFrame& frame, const ShadowPass& pass) {
    if (!has_pass(frame.plan, PassId::ShadowMaps))
        return;
    for (std::size_t k = 0; k < frame.opening.lamps.lamps.size(); ++k)
        if (frame.draws(k) && frame.plan.lamps[k].has_shadows)
            frame.device.run_pass("shadow maps", [&] {
                update_shadow_maps(frame.device, pass, frame.scene_buffers, frame.opening.lamps, k,
                                   frame.options.shadow_maps, frame.on_card.shadows[k]);
            });
}

void add_pass(GlFrame& frame,
              glm::dvec2 at_px,
              const SampleQuery& query,
              std::uint32_t camera_sample,
              float weight) {
    frame.device.run_pass("g-buffer", [&] {
        draw_surfaces(frame.scene_buffers, frame.opening.camera, at_px, frame.surfaces);
    });
    bind_surfaces(frame.surfaces.surfaces, frame.scene_buffers.materials);
    const int q = frame.options.q;
    for (std::size_t k = 0; k < frame.opening.lamps.lamps.size(); ++k) {
        if (!frame.draws(k))
            continue;
        LampPass pass{frame.opening.lamps, k, frame.plan, frame.options, query};
        pass.query.first_set += static_cast<std::uint32_t>(k * kMostSets);
        begin_lamp(frame.film);
        add_sums(frame.device, frame.passes, frame.on_card, pass, q);
        if (frame.film.bias) {
            begin_finer(frame.film);
            add_sums(frame.device, frame.passes, frame.on_card, pass, 2 * q);
            frame.device.run_pass("accumulate", [&] { end_finer(frame.film, weight); });
        }
        add_samples(frame.device, frame.passes, frame.on_card, pass);
        frame.device.run_pass("accumulate", [&] { end_lamp(frame.film, k, weight); });
    }
    if (frame.sky != nullptr) {
        begin_lamp(frame.film);
        add_sky_light(frame.device, frame.options, camera_sample, *frame.sky);
        frame.device.run_pass(
            "accumulate", [&] { end_lamp(frame.film, frame.opening.lamps.lamps.size(), weight); });
    }
    end_pass(frame.film, weight);
}

void add_passes(GlFrame& frame, const Call& call, Picture& picture, RenderReport& report) {
    const RenderOptions& options = frame.options;
    const bool is_noisy = options.sampler.has_value() || frame.plan.has_gloss;
    const bool has_goal = is_noisy && (options.error_rel > 0.0 || options.time_s > 0.0);
    const int most = options.samples > 0 ? options.samples
                     : has_goal          ? kMostSamples
                                         : kUsualSamples;
    Run run{frame, call, picture, report};
    run.samples = !has_goal              ? most
                  : options.time_s > 0.0 ? std::min(kFirstSamplesInTime, most)
                                         : std::min(kFirstSamples, most);
    run.first_samples = run.samples;
    while (run.samples > 0) {
        add_whole_pass(run, has_goal);
        if (report.passes == 1)
            run.first_s = run.pass_s;
        if (!has_goal)
            break;
        const int next =
            next_samples(options, {run.drawn, most, report.sampling, cost_of(run), run.samples,
                                   run.pass_s, options.time_s - call.elapsed_s()});
        run.samples = std::min(next, kMostGrowth * run.drawn);
    }
    report.samples = is_noisy ? run.drawn : 0.0;
}

}  // namespace nearfield::render::gpu
