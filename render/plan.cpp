// SPDX-License-Identifier: Apache-2.0
#include "render/plan.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::render {
namespace {

/// What rows of the table decide from.
struct Context {
    const Scene& scene;
    const Lamps& lamps;
    const RenderOptions& options;
    glm::ivec2 size_px;
    const Needs& needs;
    const Plan& plan;  // all but its passes
};

/// A need as the plan decides it.
using Decision = Need;

bool is_on(Switch wanted, const Need& need) {
    return wanted == Switch::Auto ? need.is_called_for : wanted == Switch::On;
}

/// The need, or that it was forced.
Decision decide(const char* effect, Switch wanted, const Need& need) {
    if (wanted == Switch::Auto)
        return need;
    const bool is_in = wanted == Switch::On;
    std::string reason = fmt::format("--effect {}={}", effect, is_in ? "on" : "off");
    if (is_in != need.is_called_for)
        reason += fmt::format(", though {}", need.reason);
    return {is_in, reason};
}

bool is_any_lit(const Plan& plan) {
    return std::any_of(plan.lamps.begin(), plan.lamps.end(),
                       [](const LampPlan& lamp) { return lamp.is_lit; });
}

std::string sampler_name(const Context& at) {
    return model::name_of(*at.options.sampler);
}

double pixels(const Context& at) {
    return static_cast<double>(at.size_px.x) * static_cast<double>(at.size_px.y);
}

/// R, G, B or Y, as floats.
double film_bytes(const Context& at) {
    constexpr double kChannels = 14.0, kOfLamp = 3.0;
    return 4.0 * pixels(at) * (kChannels + kOfLamp * static_cast<double>(at.lamps.lamps.size()));
}

double triangle_count(const Context& at) {
    double count = 0.0;
    for (const Mesh& mesh : at.scene.meshes)
        count += static_cast<double>(mesh.triangles.size());
    return count;
}

// What decides on a pass.

Decision always(const Context&) {
    return {true, "what the camera sees"};
}

Decision shadows(const Context& at) {
    return decide("shadows", at.options.effects.shadows, at.needs.shadows);
}

Decision shadow_rays(const Context& at) {
    Decision decision = shadows(at);
    if (decision.is_called_for && !at.plan.has_shadows)
        return {false, "no lamp lights anything"};
    return decision;
}

Decision light_sums(const Context& at) {
    if (at.options.sampler)
        return {false, fmt::format("--sampler {} draws all light", sampler_name(at))};
    if (!is_any_lit(at.plan))
        return {false, "no lamp lights anything"};
    return {true, "light without noise"};
}

Decision box_energies(const Context& at) {
    if (at.options.sampler)
        return {true, fmt::format("--sampler {} draws by them", sampler_name(at))};
    if (at.plan.has_gloss)
        return {true, "gloss draws by them"};
    return {false, "the light sums need no samples"};
}

Decision samples(const Context& at) {
    if (at.options.sampler)
        return {true, fmt::format("--sampler {}", sampler_name(at))};
    if (at.plan.has_shadows)
        return {true, "for shadows, by the energies of the light sums"};
    if (at.plan.has_gloss)
        return {true, "for lobes that texels do not resolve"};
    return {false, "the light sums have no noise"};
}

Decision gpu_samples(const Context& at) {
    if (at.options.sampler)
        return {true, fmt::format("--sampler {}", sampler_name(at))};
    if (at.plan.has_gloss)
        return {true, "for gloss"};
    return {false, "the light sums have no noise"};
}

Decision gloss(const Context& at) {
    return decide("gloss", at.options.effects.gloss, at.needs.gloss);
}

Decision environment(const Context& at) {
    // There is no turning on what is not there.
    if (!at.needs.environment.is_called_for)
        return at.needs.environment;
    return decide("environment", at.options.effects.environment, at.needs.environment);
}

std::string method_name(const Context& at) {
    return fmt::format("--environment {}", name_of(at.options.environment.method));
}

bool is_filtered(const Context& at) {
    return at.options.environment.method == EnvironmentMethod::Filtered;
}

Decision environment_irradiance(const Context& at) {
    if (!at.plan.has_environment)
        return {false, environment(at).reason};
    return is_filtered(at) ? at.needs.diffuse : Decision{false, method_name(at)};
}

Decision environment_samples(const Context& at) {
    if (!at.plan.has_environment)
        return {false, environment(at).reason};
    return is_filtered(at) ? gloss(at) : Decision{true, method_name(at)};
}

Decision environment_rays(const Context& at) {
    if (!at.plan.has_environment)
        return {false, environment(at).reason};
    if (is_filtered(at) && at.options.environment.directions == 0)
        return {false, "--environment-directions 0"};
    return decide("shadows", at.options.effects.shadows, at.needs.sky_shadows);
}

Decision accumulate(const Context& at) {
    if (at.options.error_rel > 0.0 || at.options.time_s > 0.0)
        return {true, "passes until an error or a time is reached"};
    if (at.options.samples_per_pixel > 1)
        return {true, fmt::format("{} samples a pixel", at.options.samples_per_pixel)};
    if (!is_any_lit(at.plan))
        return {false, "no lamp lights anything"};
    return {true, "lamp by lamp"};
}

Decision tone_mapping(const Context& at) {
    return decide("tone-mapping", at.options.effects.tone_mapping, at.needs.tone_mapping);
}

// About what a pass alone holds.

double no_bytes(const Context&) {
    return 0.0;
}

double camera_bytes(const Context& at) {
    constexpr double kOfTriangle = 200.0;  // Embree's copy and hierarchy
    return film_bytes(at) + kOfTriangle * triangle_count(at);
}

double coefficient_bytes_of(const Context& at) {
    return coefficient_bytes(at.lamps);
}

double table_bytes_of(const Context& at) {
    return table_bytes(at.lamps);
}

double sampler_bytes(const Context& at) {
    return at.options.sampler ? table_bytes(at.lamps) : 0.0;
}

double g_buffer_bytes(const Context& at) {
    constexpr double kOfPixel = 64.0;  // position, normal, tangent, material, depth
    return kOfPixel * pixels(at);
}

/// A map a cell of U and slab, or as many as are asked for.
double shadow_map_bytes(const Context& at) {
    constexpr double kOfTexel = 4.0;
    const ShadowMapOptions& options = at.options.shadow_maps;
    double maps = 0.0;
    for (std::size_t k = 0; k < at.lamps.lamps.size(); ++k) {
        double cells = 0.0;
        for (const PlacedSlab& placed : at.lamps.lamps[k].slabs) {
            const Slab& slab = placed.prepared->slab;
            const glm::dvec2 along =
                glm::dvec2(slab.grid - 1) + static_cast<double>(slab.profile.cells.size());
            cells += along.x * along.y;
        }
        if (at.plan.lamps[k].has_shadows)
            maps += options.maps > 0 ? std::min(cells, static_cast<double>(options.maps)) : cells;
    }
    return kOfTexel * options.map_px * options.map_px * maps;
}

double energy_bytes(const Context& at) {
    double images = 0.0;
    for (const Lamp& lamp : at.lamps.lamps)
        for (const PlacedSlab& placed : lamp.slabs)
            images = std::max(images, static_cast<double>(placed.prepared->slab.image_count()));
    return 4.0 * images * pixels(at);
}

double display_bytes(const Context& at) {
    constexpr double kOfPixel = 3.0;
    return kOfPixel * pixels(at);
}

struct Row {
    Device device;
    PassId id;
    const char* name;
    const char* does;
    Decision (*decides)(const Context&);
    double (*bytes)(const Context&);
};

// clang-format off
constexpr Row kPasses[] = {
    {Device::Cpu, PassId::CameraRays, "camera rays", "finds what each pixel sees", always, camera_bytes},
    {Device::Cpu, PassId::LightSums, "light sums", "sums unshadowed light, exactly", light_sums, coefficient_bytes_of},
    {Device::Cpu, PassId::Samples, "samples", "draws points on the lamps", samples, sampler_bytes},
    {Device::Cpu, PassId::ShadowRays, "shadow rays", "asks whether they are visible", shadow_rays, no_bytes},
    {Device::Cpu, PassId::Gloss, "gloss", "reflects light by materials' lobes", gloss, table_bytes_of},
    {Device::Cpu, PassId::Environment, "environment", "shows what is around where nothing is before it", environment, no_bytes},
    {Device::Cpu, PassId::EnvironmentIrradiance, "sky irradiance", "lights diffuse surfaces by spherical harmonics", environment_irradiance, no_bytes},
    {Device::Cpu, PassId::EnvironmentSamples, "sky samples", "reflects what is around by materials' lobes", environment_samples, no_bytes},
    {Device::Cpu, PassId::EnvironmentRays, "sky rays", "asks whether what is around is visible", environment_rays, no_bytes},
    {Device::Cpu, PassId::ToneMapping, "tone mapping", "makes a picture for displays", tone_mapping, display_bytes},

    {Device::Gl, PassId::GBuffer, "g-buffer", "draws what each pixel sees", always, g_buffer_bytes},
    {Device::Gl, PassId::ShadowMaps, "shadow maps", "draws what each cell of a lamp sees", shadow_rays, shadow_map_bytes},
    {Device::Gl, PassId::BoxEnergies, "box energies", "finds what each image sends to each pixel", box_energies, energy_bytes},
    {Device::Gl, PassId::LightSums, "light sums", "sums unshadowed light, exactly", light_sums, coefficient_bytes_of},
    {Device::Gl, PassId::Samples, "samples", "draws points on the lamps", gpu_samples, table_bytes_of},
    {Device::Gl, PassId::Gloss, "gloss", "reflects light by materials' lobes", gloss, no_bytes},
    {Device::Gl, PassId::Accumulate, "accumulate", "adds lamps and passes up", accumulate, film_bytes},
    {Device::Gl, PassId::ToneMapping, "tone mapping", "makes a picture for displays", tone_mapping, display_bytes},
};
// clang-format on

std::vector<PlannedPass> planned_passes(const Context& at) {
    std::vector<PlannedPass> passes;
    for (const Row& row : kPasses) {
        if (row.device != at.plan.device)
            continue;
        const Decision decision = row.decides(at);
        passes.push_back({row.id, row.name, row.does, decision.is_called_for, decision.reason,
                          decision.is_called_for ? row.bytes(at) : 0.0});
    }
    return passes;
}

LampPlan lamp_plan(const LampNeed& need, const RenderOptions& options) {
    LampPlan lamp{need.name, need.light.is_called_for, false, need.light.reason,
                  need.shadows.reason};
    if (!lamp.is_lit)
        return lamp;
    const Decision decision = decide("shadows", options.effects.shadows, need.shadows);
    lamp.has_shadows = decision.is_called_for;
    lamp.shadows_reason = decision.reason;
    return lamp;
}

}  // namespace

Plan plan_of(const Scene& scene,
             const Lamps& lamps,
             const RenderOptions& options,
             glm::ivec2 size_px,
             Device device) {
    const Needs needs = needs_of(scene, lamps, options);
    const Effects& effects = options.effects;
    Plan plan;
    plan.device = device == Device::Auto ? Device::Cpu : device;
    const Decision color = decide("color", effects.color, needs.color);
    plan.color = {color.is_called_for, needs.color.is_called_for && !color.is_called_for,
                  color.reason};
    for (const LampNeed& need : needs.lamps)
        plan.lamps.push_back(lamp_plan(need, options));
    plan.has_shadows = std::any_of(plan.lamps.begin(), plan.lamps.end(),
                                   [](const LampPlan& lamp) { return lamp.has_shadows; });
    plan.has_gloss = is_on(effects.gloss, needs.gloss);
    plan.has_tone_mapping = is_on(effects.tone_mapping, needs.tone_mapping);
    plan.has_environment =
        needs.environment.is_called_for && is_on(effects.environment, needs.environment);
    plan.draws_sky =
        plan.has_environment && (options.environment.method == EnvironmentMethod::Reference ||
                                 options.environment.method == EnvironmentMethod::Resampled);
    plan.draws_samples =
        plan.draws_sky || options.sampler.has_value() || plan.has_shadows || plan.has_gloss;
    plan.unlit = needs.unlit;
    plan.passes = planned_passes({scene, lamps, options, size_px, needs, plan});
    return plan;
}

bool plans_gloss(const Scene& scene, const RenderOptions& options) {
    return is_on(options.effects.gloss, gloss_need(scene));
}

int channels_to_load(const RenderOptions& options) {
    switch (options.effects.color) {
        case Switch::On:
            return 3;
        case Switch::Off:
            return 1;
        default:
            return 0;
    }
}

bool has_pass(const Plan& plan, PassId id) {
    return std::any_of(plan.passes.begin(), plan.passes.end(),
                       [&](const PlannedPass& pass) { return pass.id == id && pass.is_in; });
}

}  // namespace nearfield::render
