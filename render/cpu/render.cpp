// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/render.h"

#include "formats/files/error.h"
#include "formats/shared/rng.glsl.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/cpu/lamps.h"
#include "render/cpu/tracer.h"

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
constexpr int kTilePx = 16;  // 256 pixels: enough work a task, few enough idle cores at the end

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
        size_px.y = std::clamp(static_cast<int>(std::lround(size_px.x / aspect)), 1, kMaxExtentPx);
    return size_px;
}

/// The middle of one of n x n strata of a pixel, moved within it at random if n > 1. Pixel (x, y)
/// spans x ... x + 1.
glm::dvec2 film_position_px(
    glm::ivec2 pixel, int stratum, int n, std::uint32_t random_x, std::uint32_t random_y) {
    const glm::dvec2 jitter =
        n == 1 ? glm::dvec2(0.5)
               : glm::dvec2(shared::unit_float(random_x), shared::unit_float(random_y));
    return glm::dvec2(pixel) +
           (glm::dvec2(stratum % n, stratum / n) + jitter) / static_cast<double>(n);
}

glm::dvec3 camera_ray(const Camera& camera, glm::ivec2 size_px, glm::dvec2 position_px) {
    const double tan_half = std::tan(0.5 * camera.yfov_rad);
    const double px =
        2.0 * tan_half / static_cast<double>(size_px.y);  // square pixels at distance 1
    const glm::dvec3 direction((position_px.x - 0.5 * size_px.x) * px,
                               (0.5 * size_px.y - position_px.y) * px, -1.0);
    // Cameras of scenes made elsewhere may carry a scale; directions do not.
    return glm::normalize(glm::dmat3(camera.world_from_camera) * direction);
}

/// What all tiles share.
struct Frame {
    const Scene& scene;
    const RenderOptions& options;
    const Camera& camera;
    const Lamps& lamps;
    const Tracer& tracer;
    Picture& picture;
    std::vector<Reflectance> reflectances;
    int strata = 1;  // a pixel's side
};

struct TileReport {
    Scratch scratch;
    double camera_s = 0;
    std::uint64_t camera_rays = 0;
};

/// Layers in the order of make_picture.
enum LayerIndex : std::size_t {
    kRadiance,
    kIrradiance,
    kAlbedo,
    kDepth,
    kNormal,
    kSigma,
    kFirstLamp
};

Picture make_picture(const Lamps& lamps, glm::ivec2 size_px) {
    Picture picture;
    picture.size_px = size_px;
    const std::vector<std::string> rgb = {"R", "G", "B"};
    picture.layers = {{"", rgb, {}},        {"irradiance", rgb, {}},         {"albedo", rgb, {}},
                      {"depth", {"Z"}, {}}, {"normal", {"X", "Y", "Z"}, {}}, {"sigma", {"Y"}, {}}};
    for (const Lamp& lamp : lamps.lamps)
        picture.layers.push_back({"lamp." + lamp.name, rgb, {}});
    const std::size_t pixels =
        static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
    for (Layer& layer : picture.layers)
        layer.values.assign(pixels * layer.channels.size(), 0.0F);
    return picture;
}

void add(Layer& layer, std::size_t pixel, glm::vec3 value) {
    for (std::size_t c = 0; c < 3; ++c)
        layer.values[3 * pixel + c] += value[static_cast<int>(c)];
}

/// One camera sample of a pixel. Returns the variance of its radiance's luminance.
float render_sample(const Frame& frame, glm::ivec2 pixel, int stratum, TileReport& report) {
    const std::size_t index =
        static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(frame.picture.size_px.x) +
        static_cast<std::size_t>(pixel.x);
    const int samples = frame.strata * frame.strata;
    const auto key = static_cast<std::uint32_t>(index) * static_cast<std::uint32_t>(samples) +
                     static_cast<std::uint32_t>(stratum);
    const double start_s = now_s();
    const glm::uvec4 random = shared::hash4({key, ~0U, frame.options.seed, 0U});
    const glm::dvec3 origin(frame.camera.world_from_camera[3]);
    const glm::dvec3 direction =
        camera_ray(frame.camera, frame.picture.size_px,
                   film_position_px(pixel, stratum, frame.strata, random.x, random.y));
    const std::optional<Hit> hit = frame.tracer.trace(origin, direction);
    ++report.camera_rays;
    report.camera_s += now_s() - start_s;
    if (!hit)
        return 0.0F;

    const float share = 1.0F / static_cast<float>(samples);
    const Reflectance& reflectance = frame.reflectances[static_cast<std::size_t>(hit->material)];
    std::vector<Layer>& layers = frame.picture.layers;
    add(layers[kAlbedo], index, reflectance.diffuse * share);
    if (stratum == samples / 2) {  // depths and normals have no meaningful mean
        const glm::dvec3 forward = -glm::normalize(glm::dvec3(frame.camera.world_from_camera[2]));
        layers[kDepth].values[index] =
            static_cast<float>(glm::dot(hit->position_world_m - origin, forward));
        add(layers[kNormal], index, glm::vec3(hit->shading_normal));
    }
    float variance = 0.0F;
    for (std::size_t lamp = 0; lamp < frame.lamps.lamps.size(); ++lamp) {
        // Samples of one pixel share the pixel's visibility samples; 8 keep the ratio's bias small.
        const int visibility_samples = std::max(frame.options.visibility_samples / samples,
                                                std::min(8, frame.options.visibility_samples));
        const ShadeQuery query{*hit,
                               -direction,
                               reflectance,
                               {key, static_cast<std::uint32_t>(lamp)},
                               frame.options.seed,
                               visibility_samples};
        const LampLight light = shade(frame.lamps.lamps[lamp], frame.tracer, query, report.scratch);
        add(layers[kRadiance], index, light.radiance * share);
        add(layers[kIrradiance], index, light.irradiance * share);
        add(layers[kFirstLamp + lamp], index, light.radiance * share);
        variance += light.sigma_y * light.sigma_y * share * share;
    }
    return variance;
}

void render_tile(const Frame& frame, glm::ivec2 first, TileReport& report) {
    const glm::ivec2 last = glm::min(first + kTilePx, frame.picture.size_px);
    for (int y = first.y; y < last.y; ++y)
        for (int x = first.x; x < last.x; ++x) {
            float variance = 0.0F;
            for (int stratum = 0; stratum < frame.strata * frame.strata; ++stratum)
                variance += render_sample(frame, {x, y}, stratum, report);
            frame.picture.layers[kSigma]
                .values[static_cast<std::size_t>(y * frame.picture.size_px.x + x)] =
                std::sqrt(variance);
        }
}

void summarize_sigma(const Picture& picture, RenderReport& report) {
    constexpr float kFloor = 1e-3F;  // of the largest, as for relative RMS
    const std::vector<float>& rgb = picture.layers[kRadiance].values;
    const auto luminance = [&](std::size_t i) {
        return shared::luminance709({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]});
    };
    const std::size_t pixels = rgb.size() / 3;
    float brightest = 0.0F;
    for (std::size_t i = 0; i < pixels; ++i)
        brightest = std::max(brightest, luminance(i));
    double sum = 0.0;
    std::size_t lit = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (!(luminance(i) > kFloor * brightest))
            continue;
        const double relative =
            static_cast<double>(picture.layers[kSigma].values[i] / luminance(i));
        sum += relative;
        report.sigma_worst_rel = std::max(report.sigma_worst_rel, relative);
        ++lit;
    }
    report.sigma_mean_rel = lit > 0 ? sum / static_cast<double>(lit) : 0.0;
}

/// Merges in the tiles' order, and turns time spent by all threads into shares of the wall time.
void merge(const std::vector<TileReport>& tiles, double wall_s, RenderReport& report) {
    double spent_s = 0.0;
    for (const TileReport& tile : tiles) {
        report.camera_rays += tile.camera_rays;
        report.shadow_rays += tile.scratch.shadow_rays;
        report.multiply_adds += tile.scratch.multiply_adds;
        report.camera_s += tile.camera_s;
        report.sums_s += tile.scratch.sums_s;
        report.visibility_s += tile.scratch.visibility_s;
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
    const Lamps lamps = load_lamps(scene);
    report.quantity = lamps.quantity;
    report.load_s = now_s() - start_s;

    const double build_start_s = now_s();
    // More threads than cores gain nothing.
    const int cores = tbb::info::default_concurrency();
    const int threads = options.threads > 0 ? std::min(options.threads, cores) : cores;
    report.threads = threads;
    const Tracer tracer(scene, lamps.instance_masks, threads);
    report.build_s = now_s() - build_start_s;

    result.picture = make_picture(lamps, complete_size(options.size_px, camera));
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
    summarize_sigma(result.picture, report);
    return result;
}

}  // namespace nearfield::render
