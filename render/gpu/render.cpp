// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/render.h"

#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "render/film.h"
#include "render/gpu/headless.h"
#include "render/gpu/passes.h"
#include "render/gpu/storage.h"
#include "render/materials.h"
#include "render/opening.h"

#include <thread>

namespace nearfield::render {
namespace {

namespace card = gpu;

/// Albedo, depth and normal of what is drawn.
void read_surfaces(const card::GlFrame& frame,
                   const std::vector<shared::Brdf>& brdfs,
                   Picture& picture) {
    const card::Surfaces& surfaces = frame.surfaces.surfaces;
    const std::vector<float> position = card::read_back(surfaces.position, surfaces.size_px, 4);
    const std::vector<float> normal = card::read_back(surfaces.normal, surfaces.size_px, 4);
    for (std::size_t k = 0; 4 * k < position.size(); ++k) {
        const int material = static_cast<int>(position[4 * k + 3]) - 1;
        if (material < 0)
            continue;
        for (std::size_t c = 0; c < 3; ++c) {
            picture.layers[kAlbedo].values[3 * k + c] =
                brdfs[static_cast<std::size_t>(material)].diffuse[static_cast<int>(c)];
            picture.layers[kNormal].values[3 * k + c] = normal[4 * k + c];
        }
        picture.layers[kDepth].values[k] = normal[4 * k + 3];
    }
}

/// What drawing keeps from lamp to lamp.
std::uint64_t energy_bytes(const card::LightSamples& samples) {
    return samples.entries * sizeof(float) + samples.totals * sizeof(double) +
           samples.luminances * sizeof(float);
}

/// What passes hold that is made once, before they run.
std::uint64_t bytes_before(const card::GlFrame& frame, std::uint64_t surface_bytes, PassId id) {
    const glm::ivec2 size_px = frame.film.size_px;
    const auto pixels =
        static_cast<std::uint64_t>(size_px.x) * static_cast<std::uint64_t>(size_px.y);
    switch (id) {
        case PassId::GBuffer:
            return surface_bytes;
        case PassId::LightSums:
            return frame.on_card.sum_bytes;
        case PassId::BoxEnergies:
            return energy_bytes(frame.passes.samples) +
                   energy_bytes(frame.passes.unshadowed_samples);
        case PassId::Samples:
            return frame.on_card.table_bytes;
        case PassId::Accumulate:
            return pixels * (16U * (4U + frame.film.of_lamp.size()) + (frame.film.bias ? 36U : 0U));
        default:
            return 0;
    }
}

/// Costs by the plan's passes.
void merge_costs(const card::GlFrame& frame, std::uint64_t surface_bytes, RenderReport& report) {
    for (const PlannedPass& pass : report.plan.passes) {
        PassReport cost{pass.id, 0.0,
                        static_cast<double>(bytes_before(frame, surface_bytes, pass.id))};
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
    const Call call = begin_call(options, hooks);
    const card::HeadlessContext context;
    card::Device device;
    Rendered result;
    RenderReport& report = result.report;
    report.device = device.renderer();
    report.threads = static_cast<int>(std::thread::hardware_concurrency());
    const Opening opening = open_scene(scene, options, Device::Gl, report);
    const Lamps& lamps = opening.lamps;
    const Plan& plan = report.plan;
    if (plan.has_environment)
        throw Error{"cannot render by OpenGL", "environment",
                    "none, or --effect environment=off: the CPU renders it", "one"};
    const bool has_bias = !options.sampler && options.q > 0;
    result.picture = make_picture(lamps, opening.size_px, {});
    if (has_bias)
        add_bias_layer(result.picture);

    const double build_start_s = now_s();
    std::vector<shared::Brdf> brdfs;
    for (const Material& material : scene.materials)
        brdfs.push_back(planned_brdf(material, plan));
    card::GlFrame frame{scene, options, opening, plan, device, {}, {}, {}, {}, {}};
    frame.scene_buffers = card::upload_scene(device, scene);
    frame.scene_buffers.materials = card::upload_materials(device, brdfs);
    frame.surfaces = card::make_surface_pass(device, frame.scene_buffers, opening.size_px);
    const std::uint64_t surface_bytes = device.allocated_bytes();
    frame.on_card = card::upload_lamps(device, lamps, plan, options);
    report.lamp_bytes = static_cast<double>(frame.on_card.sum_bytes + frame.on_card.table_bytes);
    frame.passes = card::make_light_passes(device, plan, options, frame.surfaces.has_tangents);
    frame.film = card::make_film(device, opening.size_px, lamps.lamps.size(), has_bias);
    report.build_s = now_s() - build_start_s;

    card::draw_shadow_maps(frame);
    card::add_passes(frame, call, result.picture, report);
    read_surfaces(frame, brdfs, result.picture);
    merge_costs(frame, surface_bytes, report);
    report.q = options.sampler ? 0 : options.q;
    end_call(call, options, report);
    return result;
}

}  // namespace nearfield::render
