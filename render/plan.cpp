// SPDX-License-Identifier: Apache-2.0
#include "render/plan_rows.h"

#include <algorithm>

namespace nearfield::render::rows {
namespace {

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
    {Device::Gl, PassId::Environment, "environment", "shows what is around where nothing is before it", environment, no_bytes},
    {Device::Gl, PassId::EnvironmentMaps, "sky maps", "draws what is seen from where most of the sky's light comes, and fits it", environment_rays, sky_map_bytes},
    {Device::Gl, PassId::EnvironmentIrradiance, "sky irradiance", "lights diffuse surfaces by spherical harmonics", environment_irradiance, no_bytes},
    {Device::Gl, PassId::EnvironmentSamples, "sky samples", "reflects what is around by materials' lobes", environment_samples, no_bytes},
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
}  // namespace nearfield::render::rows

namespace nearfield::render {

using rows::decide, rows::Decision, rows::is_on;

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
        plan.lamps.push_back(rows::lamp_plan(need, options));
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
    plan.passes = rows::planned_passes({scene, lamps, options, size_px, needs, plan});
    return plan;
}

bool hides_sky(const Plan& plan) {
    return has_pass(plan, PassId::EnvironmentRays) || has_pass(plan, PassId::EnvironmentMaps);
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
