// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"

#include "formats/files/provenance.h"
#include "render/cpu/passes.h"
#include "render/materials.h"
#include "render/opening.h"
#include "render/seen_lamps.h"

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace nearfield::render {
namespace {

/// Coefficients count for the sums if there are any, else for the samples; tables for who draws by
/// them.
double bytes_of(PassId id, const Lamps& lamps, const RenderReport& report) {
    const bool has_sums = has_pass(report.plan, PassId::LightSums);
    switch (id) {
        case PassId::LightSums:
            return coefficient_bytes(lamps);
        case PassId::Samples:
            return has_sums ? 0.0 : coefficient_bytes(lamps) + table_bytes(lamps);
        case PassId::Gloss:
            return has_sums ? table_bytes(lamps) : 0.0;
        default:
            return 0.0;
    }
}

}  // namespace

Rendered render_cpu(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks) {
    const Call call = begin_call(options, hooks);
    Rendered result;
    RenderReport& report = result.report;
    report.device = "CPU";
    const Opening opening = open_scene(scene, options, Device::Cpu, report);
    const Lamps& lamps = opening.lamps;

    const double build_start_s = now_s();
    // More threads than cores gain nothing.
    const int cores = tbb::info::default_concurrency();
    const int threads = options.threads > 0 ? std::min(options.threads, cores) : cores;
    report.threads = threads;
    const Tracer tracer(scene, lamps.instance_masks, threads);
    report.build_s = now_s() - build_start_s;

    result.picture = make_picture(lamps, opening.size_px,
                                  {report.plan.has_environment, report.has_sigma_measured});
    Frame frame{
        scene, options, opening.camera, lamps, tracer, report.plan, result.picture, {}, 1, {},
        {},    {},      nullptr};
    frame.strata = strata_per_side(options.samples_per_pixel);
    for (const Material& material : scene.materials)
        frame.brdfs.push_back(planned_brdf(material, report.plan));
    frame.measured_layer = find_layer(result.picture, "sigma_measured");
    frame.environment_layer = find_layer(result.picture, "environment");
    frame.sky = opening.sky ? &*opening.sky : nullptr;
    tbb::task_arena arena(threads);
    arena.execute([&] { render_passes(frame, call.hooks, call.start_s, report); });
    for (PassReport& cost : report.costs)
        cost.bytes = cost.id == PassId::CameraRays ? tracer.bytes() + layer_bytes(result.picture)
                                                   : bytes_of(cost.id, lamps, report);
    if (opening.sky)
        report.costs.push_back({PassId::Environment, opening.sky->load_s,
                                environment::bytes(*opening.sky->environment)});
    report.sampling =
        summarize_noise(result.picture.layers[kRadiance], result.picture.layers[kSigma],
                        frame.bias_layer ? &result.picture.layers[*frame.bias_layer] : nullptr,
                        &result.picture.layers[kDepth]);
    if (options.shows_lamps)
        add_seen_lamps(opening, options, std::nullopt, result.picture);
    end_call(call, options, report);
    return result;
}

}  // namespace nearfield::render
