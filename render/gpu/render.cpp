// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/render.h"

#include "formats/files/provenance.h"
#include "render/film.h"
#include "render/gpu/film.h"
#include "render/gpu/headless.h"
#include "render/gpu/lamps.h"
#include "render/gpu/scene_buffers.h"
#include "render/gpu/storage.h"
#include "render/gpu/surfaces.h"
#include "render/materials.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace nearfield::render {
namespace {

namespace card = gpu;

/// What a frame is drawn from, and into.
struct GlFrame {
    const Scene& scene;
    const RenderOptions& options;
    const RenderHooks& hooks;
    const Camera& camera;
    const Lamps& lamps;
    const Plan& plan;
    card::Device& device;
    card::SceneBuffers scene_buffers;
    card::SurfacePass surfaces;
    card::LampsOnCard on_card;
    card::LightPasses passes;
    card::Film film;
    std::uint64_t surface_bytes = 0;
};

LampParts parts_of(const Scene& scene, const RenderOptions& options) {
    LampParts parts;
    parts.tables = options.sampler.has_value() || plans_gloss(scene, options);
    parts.mips = !options.sampler && options.q > 0;
    parts.channels = channels_to_load(options);
    return parts;
}

void draw_shadow_maps(GlFrame& frame) {
    if (!has_pass(frame.plan, PassId::ShadowMaps))
        return;
    const card::ShadowPass pass = card::make_shadow_pass();
    for (std::size_t k = 0; k < frame.lamps.lamps.size(); ++k)
        if (frame.plan.lamps[k].is_lit && frame.plan.lamps[k].has_shadows)
            frame.device.run_pass("shadow maps", [&] {
                card::update_shadow_maps(frame.device, pass, frame.scene_buffers, frame.lamps, k,
                                         frame.options.shadow_maps, frame.on_card.shadows[k]);
            });
}

/// Albedo, depth and normal of what is drawn.
void read_surfaces(const GlFrame& frame, const std::vector<glm::vec3>& albedos, Picture& picture) {
    const card::Surfaces& surfaces = frame.surfaces.surfaces;
    const std::vector<float> position = card::read_back(surfaces.position, surfaces.size_px, 4);
    const std::vector<float> normal = card::read_back(surfaces.normal, surfaces.size_px, 4);
    for (std::size_t k = 0; 4 * k < position.size(); ++k) {
        const int material = static_cast<int>(position[4 * k + 3]) - 1;
        if (material < 0)
            continue;
        for (std::size_t c = 0; c < 3; ++c) {
            picture.layers[kAlbedo].values[3 * k + c] =
                albedos[static_cast<std::size_t>(material)][static_cast<int>(c)];
            picture.layers[kNormal].values[3 * k + c] = normal[4 * k + c];
        }
        picture.layers[kDepth].values[k] = normal[4 * k + 3];
    }
}

/// One sample of each pixel at `at_px` of it, lit by every lamp.
/// Sets are numbered through passes, strata and lamps; first_set: of the first lamp.
void add_pass(GlFrame& frame, glm::dvec2 at_px, std::uint32_t first_set, card::SampleQuery query) {
    frame.device.run_pass("g-buffer", [&] {
        card::draw_surfaces(frame.scene_buffers, frame.camera, at_px, frame.surfaces);
    });
    card::bind_surfaces(frame.surfaces.surfaces, frame.scene_buffers.materials);
    for (std::size_t k = 0; k < frame.lamps.lamps.size(); ++k) {
        if (!frame.plan.lamps[k].is_lit)
            continue;
        query.first_set = first_set + static_cast<std::uint32_t>(k * kMostSets);
        card::begin_lamp(frame.film);
        card::add_light(frame.device, frame.passes, frame.on_card,
                        {frame.lamps, k, frame.plan, frame.options, query});
        frame.device.run_pass("accumulate", [&] { card::end_lamp(frame.film, k, 1.0F); });
    }
    card::end_pass(frame.film, 1.0F);
}

Noise noise_of(const card::Film& film, float root, Picture& picture) {
    card::read_film(film, root, picture);
    return summarize_noise(picture.layers[kRadiance], picture.layers[kSigma]);
}

/// Passes over all strata until what is asked for is reached.
void add_passes(GlFrame& frame, double call_s, Picture& picture, RenderReport& report) {
    const RenderOptions& options = frame.options;
    const int strata = strata_per_side(options.samples_per_pixel);
    const int samples = options.samples > 0 ? options.samples : kUsualSamples;
    card::SampleQuery query;
    query.size_px = picture.size_px;
    query.sets = sets_of(options, samples);
    query.seed = options.seed;
    std::uint32_t first_set = 0;
    const bool is_noisy = options.sampler.has_value() || frame.plan.has_gloss;
    const bool has_goal = is_noisy && (options.error_rel > 0.0 || options.time_s > 0.0);
    const int most = has_goal && options.samples > 0 ? 1 : kMostSamples / samples;
    double pass_s = 0.0;
    do {
        const double start_s = frame.hooks.clock_s();
        for (int stratum = 0; stratum < strata * strata; ++stratum) {
            const glm::dvec2 at_px = (glm::dvec2(stratum % strata, stratum / strata) + 0.5) /
                                     static_cast<double>(strata);
            add_pass(frame, at_px, first_set, query);
            first_set += static_cast<std::uint32_t>(frame.lamps.lamps.size() * kMostSets);
            if (frame.hooks.progress)
                frame.hooks.progress({(stratum + 1.0) / (strata * strata), report.passes,
                                      report.sampling.error_rel()});
        }
        ++report.passes;
        const double degrees =
            static_cast<double>(query.sets.sets - 1) * report.passes * strata * strata;
        const auto root = static_cast<float>(degrees > 0.0 ? unbiased_root(degrees) : 1.0);
        report.sampling = noise_of(frame.film, root, picture);
        pass_s = frame.hooks.clock_s() - start_s;
    } while (has_goal && report.passes < most &&
             !(options.error_rel > 0.0 && report.sampling.error_rel() <= options.error_rel) &&
             !(options.time_s > 0.0 && frame.hooks.clock_s() - call_s + pass_s > options.time_s));
    report.samples = static_cast<double>(samples) * report.passes;
}

/// What passes hold that is made once, before they run.
std::uint64_t bytes_before(const GlFrame& frame, PassId id) {
    const glm::ivec2 size_px = frame.film.size_px;
    const auto pixels =
        static_cast<std::uint64_t>(size_px.x) * static_cast<std::uint64_t>(size_px.y);
    switch (id) {
        case PassId::GBuffer:
            return frame.surface_bytes;
        case PassId::LightSums:
            return frame.on_card.sum_bytes;
        case PassId::Samples:
            return frame.on_card.table_bytes;
        case PassId::Accumulate:
            return pixels * 16U * (4U + frame.film.of_lamp.size());
        default:
            return 0;
    }
}

/// Costs by the plan's passes.
void merge_costs(const GlFrame& frame, RenderReport& report) {
    for (const PlannedPass& pass : report.plan.passes) {
        PassReport cost{pass.id, 0.0, static_cast<double>(bytes_before(frame, pass.id))};
        for (const card::PassCost& one : frame.device.costs())
            if (one.name == pass.name) {
                cost.time_s += one.time_s;
                cost.bytes += static_cast<double>(one.bytes);
            }
        if (pass.is_in)
            report.costs.push_back(cost);
    }
}

}  // namespace

Rendered render_gl(const Scene& scene, const RenderOptions& options, const RenderHooks& hooks) {
    check(options);
    RenderHooks timed = hooks;
    if (!timed.clock_s)
        timed.clock_s = now_s;
    const double call_s = timed.clock_s();
    const card::HeadlessContext context;
    card::Device device;
    Rendered result;
    RenderReport& report = result.report;
    const Camera& camera = find_camera(scene, options.camera);
    const double load_start_s = now_s();
    const Lamps lamps = load_lamps(scene, parts_of(scene, options));
    report.quantity = lamps.quantity;
    report.load_s = now_s() - load_start_s;
    const glm::ivec2 size_px = complete_size(options.size_px, camera);
    report.plan = plan_of(scene, lamps, options, size_px, Device::Gl);
    report.device = device.renderer();
    report.threads = static_cast<int>(std::thread::hardware_concurrency());
    result.picture = make_picture(lamps, size_px, false);

    const double build_start_s = now_s();
    GlFrame frame{scene, options, timed, camera, lamps, report.plan, device, {}, {}, {}, {}, {}, 0};
    std::vector<shared::Brdf> brdfs;
    std::vector<glm::vec3> albedos;
    for (const Material& material : scene.materials) {
        brdfs.push_back(planned_brdf(material, report.plan));
        albedos.push_back(brdfs.back().diffuse);
    }
    frame.scene_buffers = card::upload_scene(device, scene);
    frame.scene_buffers.materials = card::upload_materials(device, brdfs);
    frame.surfaces = card::make_surface_pass(device, frame.scene_buffers, size_px);
    frame.surface_bytes = device.allocated_bytes();
    frame.on_card = card::upload_lamps(device, lamps, report.plan, options);
    report.lamp_bytes = static_cast<double>(frame.on_card.sum_bytes + frame.on_card.table_bytes);
    frame.passes =
        card::make_light_passes(device, report.plan, options, frame.surfaces.has_tangents);
    frame.film = card::make_film(device, size_px, lamps.lamps.size());
    report.build_s = now_s() - build_start_s;

    draw_shadow_maps(frame);
    add_passes(frame, call_s, result.picture, report);
    read_surfaces(frame, albedos, result.picture);
    merge_costs(frame, report);
    report.q = options.sampler ? 0 : options.q;
    report.is_error_reached =
        !(options.error_rel > 0.0) || report.sampling.error_rel() <= options.error_rel;
    report.time_s = timed.clock_s() - call_s;
    return result;
}

}  // namespace nearfield::render
