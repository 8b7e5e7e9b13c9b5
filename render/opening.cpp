// SPDX-License-Identifier: Apache-2.0
#include "render/opening.h"

#include "formats/files/provenance.h"
#include "render/film.h"

#include <algorithm>
#include <utility>

namespace nearfield::render {
namespace {

/// Samplers other than the sum read tables, and so do glossy lobes.
LampParts parts_of(const Scene& scene, const RenderOptions& options, Device device) {
    LampParts parts;
    parts.tables = options.sampler.has_value() || plans_gloss(scene, options);
    // Within a time a coarser sum may be what fits: on the CPU.
    const bool may_coarsen = device == Device::Cpu && options.time_s > 0.0;
    parts.mips = !options.sampler && (options.q > 0 || may_coarsen);
    parts.measured = device == Device::Cpu && options.sigma_measured;
    parts.channels = channels_to_load(options);
    return parts;
}

}  // namespace

Call begin_call(const RenderOptions& options, const RenderHooks& hooks) {
    check(options);
    Call call{hooks, 0.0};
    if (!call.hooks.clock_s)
        call.hooks.clock_s = now_s;
    call.start_s = call.hooks.clock_s();
    return call;
}

Opening open_scene(const Scene& scene,
                   const RenderOptions& options,
                   Device device,
                   RenderReport& report) {
    KeptFiles files;
    return open_scene(scene, options, device, files, report);
}

Opening open_scene(const Scene& scene,
                   const RenderOptions& options,
                   Device device,
                   KeptFiles& kept,
                   RenderReport& report) {
    const Camera& camera = find_camera(scene, options.camera);
    const double start_s = now_s();
    Opening opening{camera, load_lamps(scene, parts_of(scene, options, device), kept.lamps),
                    complete_size(options.size_px, camera), std::nullopt};
    report.has_sigma_measured =
        std::any_of(opening.lamps.lamps.begin(), opening.lamps.lamps.end(),
                    [](const Lamp& lamp) { return lamp.file->measured.has_value(); });
    report.quantity = opening.lamps.quantity;
    report.plan = plan_of(scene, opening.lamps, options, opening.size_px, device);
    opening.sky = load_sky(scene, report.plan, options.environment, kept.sky);
    report.load_s = now_s() - start_s;
    return opening;
}

void end_call(const Call& call, const RenderOptions& options, RenderReport& report) {
    report.is_error_reached =
        !(options.error_rel > 0.0) || report.sampling.error_rel() <= options.error_rel;
    report.time_s = call.elapsed_s();
}

}  // namespace nearfield::render
