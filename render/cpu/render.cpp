// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"

#include "formats/files/provenance.h"
#include "render/cpu/passes.h"
#include "render/materials.h"

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace nearfield::render {
namespace {

/// Samplers other than the sum read tables, and so do glossy lobes.
LampParts parts_of(const Scene& scene, const RenderOptions& options) {
    LampParts parts;
    parts.tables = options.sampler.has_value() || plans_gloss(scene, options);
    // Within a time a coarser sum may be what fits.
    parts.mips = !options.sampler && (options.q > 0 || options.time_s > 0.0);
    parts.measured = options.sigma_measured;
    parts.channels = channels_to_load(options);
    return parts;
}

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
    check(options);
    RenderHooks timed = hooks;
    if (!timed.clock_s)
        timed.clock_s = now_s;
    const double call_s = timed.clock_s();
    Rendered result;
    RenderReport& report = result.report;
    report.device = "CPU";
    const Camera& camera = find_camera(scene, options.camera);
    const double start_s = now_s();
    const Lamps lamps = load_lamps(scene, parts_of(scene, options));
    report.has_sigma_measured =
        std::any_of(lamps.lamps.begin(), lamps.lamps.end(),
                    [](const Lamp& lamp) { return lamp.file->measured.has_value(); });
    report.quantity = lamps.quantity;
    report.load_s = now_s() - start_s;
    const glm::ivec2 size_px = complete_size(options.size_px, camera);
    report.plan = plan_of(scene, lamps, options, size_px, Device::Cpu);

    const double build_start_s = now_s();
    // More threads than cores gain nothing.
    const int cores = tbb::info::default_concurrency();
    const int threads = options.threads > 0 ? std::min(options.threads, cores) : cores;
    report.threads = threads;
    const Tracer tracer(scene, lamps.instance_masks, threads);
    report.build_s = now_s() - build_start_s;

    result.picture = make_picture(lamps, size_px, report.has_sigma_measured);
    Frame frame{scene, options, camera, lamps, tracer, report.plan, result.picture, {}, 1, {}, {}};
    frame.strata = strata_per_side(options.samples_per_pixel);
    for (const Material& material : scene.materials)
        frame.brdfs.push_back(planned_brdf(material, report.plan));
    if (report.has_sigma_measured)
        frame.measured_layer = result.picture.layers.size() - 1;
    tbb::task_arena arena(threads);
    arena.execute([&] { render_passes(frame, timed, call_s, report); });
    for (PassReport& cost : report.costs)
        cost.bytes = cost.id == PassId::CameraRays ? tracer.bytes() + layer_bytes(result.picture)
                                                   : bytes_of(cost.id, lamps, report);
    report.sampling =
        summarize_noise(result.picture.layers[kRadiance], result.picture.layers[kSigma],
                        frame.bias_layer ? &result.picture.layers[*frame.bias_layer] : nullptr);
    report.is_error_reached =
        !(options.error_rel > 0.0) || report.sampling.error_rel() <= options.error_rel;
    report.time_s = timed.clock_s() - call_s;
    return result;
}

}  // namespace nearfield::render
