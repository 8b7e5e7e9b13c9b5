// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"

#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "render/cpu/tile.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace nearfield::render {
namespace {

constexpr int kMaxExtentPx = 16384;

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
    const std::size_t pixels =
        static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
    for (Layer& layer : picture.layers)
        layer.values.assign(pixels * layer.channels.size(), 0.0F);
    return picture;
}

/// Merges in the tiles' order, and turns time spent by all threads into shares of the wall time.
void merge(const std::vector<TileReport>& tiles, double wall_s, RenderReport& report) {
    double spent_s = 0.0;
    for (const TileReport& tile : tiles) {
        report.camera_rays += tile.camera_rays;
        report.shadow_rays += tile.shadow_rays;
        report.multiply_adds += static_cast<double>(tile.multiply_adds);
        report.camera_s += tile.camera_s;
        report.sums_s += tile.sums_s;
        report.visibility_s += tile.visibility_s;
    }
    spent_s = report.camera_s + report.sums_s + report.visibility_s;
    const double share = spent_s > 0.0 ? wall_s / spent_s : 0.0;
    report.camera_s *= share;
    report.sums_s *= share;
    report.visibility_s *= share;
}

void render_tiles(const Frame& frame,
                  const std::function<void(double fraction)>& progress,
                  std::vector<TileReport>& reports) {
    const glm::ivec2 tiles = (frame.picture.size_px + kTilePx - 1) / kTilePx;
    reports.resize(static_cast<std::size_t>(tiles.x) * static_cast<std::size_t>(tiles.y));
    std::mutex progress_mutex;
    std::size_t done = 0;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, reports.size(), 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t t = range.begin(); t < range.end(); ++t) {
                const int tile = static_cast<int>(t);
                render_tile(frame, glm::ivec2(tile % tiles.x, tile / tiles.x) * kTilePx,
                            reports[t]);
                const std::lock_guard lock(progress_mutex);
                ++done;
                if (progress)
                    progress(static_cast<double>(done) / static_cast<double>(reports.size()));
            }
        },
        tbb::simple_partitioner());
}

}  // namespace

void check(const RenderOptions& options) {
    const auto refuse = [](const char* option, const std::string& expected, int got) {
        throw Error{"cannot render", option, expected, fmt::format("{}", got)};
    };
    for (int axis = 0; axis < 2; ++axis)
        if (options.size_px[axis] < 1 - axis || options.size_px[axis] > kMaxExtentPx)
            refuse(axis == 0 ? "width" : "height",
                   axis == 0 ? "1 ... 16384" : "0 (automatic) ... 16384", options.size_px[axis]);
    const int side =
        static_cast<int>(std::lround(std::sqrt(std::max(options.samples_per_pixel, 0))));
    if (options.samples_per_pixel < 1 || options.samples_per_pixel > 1024 ||
        side * side != options.samples_per_pixel)
        refuse("samples per pixel", "a square number, 1, 4, 9 ... 1024", options.samples_per_pixel);
    if (options.visibility_samples < 2 || options.visibility_samples > 1 << 20)
        refuse("visibility samples", "2 ... 1048576", options.visibility_samples);
    if (options.threads < 0 || options.threads > 4096)
        refuse("threads", "0 (all) ... 4096", options.threads);
}

Rendered render(const Scene& scene,
                const RenderOptions& options,
                const std::function<void(double fraction)>& progress) {
    check(options);
    Rendered result;
    RenderReport& report = result.report;
    const Camera& camera = find_camera(scene, options.camera);
    const double start_s = now_s();
    const Lamps lamps = load_lamps(scene, options.sigma_measured);
    report.has_sigma_measured =
        std::any_of(lamps.lamps.begin(), lamps.lamps.end(),
                    [](const Lamp& lamp) { return lamp.measured != nullptr; });
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
    Frame frame{scene,  options,
                camera, lamps,
                tracer, result.picture,
                {},     static_cast<int>(std::lround(std::sqrt(options.samples_per_pixel)))};
    for (const Material& material : scene.materials)
        frame.reflectances.push_back(reflectance(material));
    std::vector<TileReport> tiles;
    const double tiles_start_s = now_s();
    tbb::task_arena arena(threads);
    arena.execute([&] { render_tiles(frame, progress, tiles); });
    merge(tiles, now_s() - tiles_start_s, report);
    report.sampling =
        summarize_noise(result.picture.layers[kRadiance], result.picture.layers[kSigma]);
    return result;
}

}  // namespace nearfield::render
