// SPDX-License-Identifier: Apache-2.0
#include "render/plan_rows.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::render::rows {
namespace {

bool is_any_lit(const Plan& plan) {
    return std::any_of(plan.lamps.begin(), plan.lamps.end(),
                       [](const LampPlan& lamp) { return lamp.is_lit; });
}

std::string sampler_name(const Context& at) {
    return model::name_of(*at.options.sampler);
}

std::string method_name(const Context& at) {
    return fmt::format("--environment {}", name_of(at.options.environment.method));
}

bool is_filtered(const Context& at) {
    return at.options.environment.method == EnvironmentMethod::Filtered;
}

}  // namespace

bool is_on(Switch wanted, const Need& need) {
    return wanted == Switch::Auto ? need.is_called_for : wanted == Switch::On;
}

Decision decide(const char* effect, Switch wanted, const Need& need) {
    if (wanted == Switch::Auto)
        return need;
    const bool is_in = wanted == Switch::On;
    std::string reason = fmt::format("--effect {}={}", effect, is_in ? "on" : "off");
    if (is_in != need.is_called_for)
        reason += fmt::format(", though {}", need.reason);
    return {is_in, reason};
}

Decision always(const Context& /*at*/) {
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
    if (is_any_lit(at.plan))
        return {true,
                at.plan.has_environment ? "lamp by lamp, and what is around" : "lamp by lamp"};
    if (at.plan.has_environment)
        return {true, "what is around"};
    return {false, "no lamp lights anything"};
}

Decision tone_mapping(const Context& at) {
    return decide("tone-mapping", at.options.effects.tone_mapping, at.needs.tone_mapping);
}

}  // namespace nearfield::render::rows
