// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"

#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "render/cpu/limits.h"
#include "render/cpu/passes.h"

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

namespace nearfield::render {
namespace {

const Camera& find_camera(const Scene& scene, const std::string& name) {
    std::string names;
    for (const Camera& camera : scene.cameras) {
        if (name.empty() || camera.name == name)
            return camera;
        names += (names.empty() ? "" : ", ") + camera.name;
    }
    throw Error{"no such camera", "scene", names.empty() ? "a scene with a camera" : names,
                name.empty() ? "none" : "'" + name + "'"};
}

glm::ivec2 complete_size(glm::ivec2 size_px, const Camera& camera) {
    constexpr double kUsualAspect = 4.0 / 3.0;
    const double aspect = camera.aspect > 0.0 ? camera.aspect : kUsualAspect;
    if (size_px.y == 0)
        // Clamped before the conversion: an aspect may be 1e-300.
        size_px.y = static_cast<int>(
            std::lround(std::clamp(size_px.x / aspect, 1.0, static_cast<double>(kMaxExtentPx))));
    return size_px;
}

Picture make_picture(const Lamps& lamps, glm::ivec2 size_px, bool has_measured) {
    Picture picture;
    picture.size_px = size_px;
    const std::vector<std::string> rgb = {"R", "G", "B"};
    picture.layers = {{"", rgb, {}},        {"irradiance", rgb, {}},         {"albedo", rgb, {}},
                      {"depth", {"Z"}, {}}, {"normal", {"X", "Y", "Z"}, {}}, {"sigma", {"Y"}, {}}};
    for (const Lamp& lamp : lamps.lamps)
        picture.layers.push_back({"lamp." + lamp.name, rgb, {}});
    if (has_measured)
        picture.layers.push_back({"sigma_measured", {"Y"}, {}});
    return picture;
}

void allocate(Picture& picture) {
    const std::size_t pixels =
        static_cast<std::size_t>(picture.size_px.x) * static_cast<std::size_t>(picture.size_px.y);
    for (Layer& layer : picture.layers)
        layer.values.assign(pixels * layer.channels.size(), 0.0F);
}

/// The layers' floats, and what finding errors and a PNG take at most besides.
double bytes_per_pixel(const Picture& picture) {
    double floats = 0.0;
    for (const Layer& layer : picture.layers)
        floats += static_cast<double>(layer.channels.size());
    constexpr double kBesides = 32.0;
    return 4.0 * floats + kBesides;
}

void check_memory(const Picture& picture) {
    const double needed =
        bytes_per_pixel(picture) * picture.size_px.x * static_cast<double>(picture.size_px.y);
    const double available = available_memory_bytes();
    constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
    if (needed > available)
        throw Error{"the picture is larger than the memory that is left",
                    fmt::format("{} x {} pixels", picture.size_px.x, picture.size_px.y),
                    fmt::format("at most {:.1f} GiB", available / kGiB),
                    fmt::format("{:.1f} GiB", needed / kGiB)};
}

/// Samplers other than the sum read tables, and so do glossy lobes.
LampNeeds needs_of(const Scene& scene, const RenderOptions& options) {
    LampNeeds needs;
    needs.tables = options.sampler.has_value() ||
                   std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& mesh) {
                       return shared::brdf_is_glossy(
                           brdf(scene.materials[static_cast<std::size_t>(mesh.material)]));
                   });
    // Within a time a coarser sum may be what fits.
    needs.mips = !options.sampler && (options.q > 0 || options.time_s > 0.0);
    needs.measured = options.sigma_measured;
    return needs;
}

}  // namespace

Rendered render(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks) {
    check(options);
    RenderHooks timed = hooks;
    if (!timed.clock_s)
        timed.clock_s = now_s;
    const double call_s = timed.clock_s();
    Rendered result;
    RenderReport& report = result.report;
    const Camera& camera = find_camera(scene, options.camera);
    const double start_s = now_s();
    const Lamps lamps = load_lamps(scene, needs_of(scene, options));
    report.has_sigma_measured =
        std::any_of(lamps.lamps.begin(), lamps.lamps.end(),
                    [](const Lamp& lamp) { return lamp.file->measured.has_value(); });
    report.quantity = lamps.quantity;
    report.load_s = now_s() - start_s;

    const double build_start_s = now_s();
    // More threads than cores gain nothing.
    const int cores = tbb::info::default_concurrency();
    const int threads = options.threads > 0 ? std::min(options.threads, cores) : cores;
    report.threads = threads;
    const Tracer tracer(scene, lamps.instance_masks, threads);
    report.build_s = now_s() - build_start_s;

    result.picture =
        make_picture(lamps, complete_size(options.size_px, camera), report.has_sigma_measured);
    check_memory(result.picture);
    allocate(result.picture);
    Frame frame{scene, options, camera, lamps, tracer, result.picture, {}, 1, {}, {}};
    frame.strata = static_cast<int>(std::lround(std::sqrt(options.samples_per_pixel)));
    for (const Material& material : scene.materials)
        frame.brdfs.push_back(brdf(material));
    if (report.has_sigma_measured)
        frame.measured_layer = result.picture.layers.size() - 1;
    tbb::task_arena arena(threads);
    arena.execute([&] { render_passes(frame, timed, call_s, report); });
    report.sampling =
        summarize_noise(result.picture.layers[kRadiance], result.picture.layers[kSigma],
                        frame.bias_layer ? &result.picture.layers[*frame.bias_layer] : nullptr);
    report.is_error_reached =
        !(options.error_rel > 0.0) || report.sampling.error_rel() <= options.error_rel;
    report.time_s = timed.clock_s() - call_s;
    return result;
}

}  // namespace nearfield::render
