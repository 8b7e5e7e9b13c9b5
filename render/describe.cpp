// SPDX-License-Identifier: Apache-2.0
#include "formats/files/provenance.h"
#include "formats/shared/tonemap.glsl.h"
#include "render/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace nearfield::render {

namespace {

std::string name_of_sampler(const RenderOptions& options) {
    return options.sampler ? model::name_of(*options.sampler) : "sum";
}

std::string passes(const RenderReport& report, const RenderOptions& options) {
    std::string text =
        fmt::format("{} sampler, {} pass{} of {:.4g} samples in all", name_of_sampler(options),
                    report.passes, report.passes == 1 ? "" : "es", report.samples);
    if (report.q > 0)
        text += fmt::format(", q = {}{}", report.q,
                            options.q == 0 ? " (an exact sum would take too long)" : "");
    return text;
}

std::string goal(const RenderReport& report, const RenderOptions& options) {
    std::string text;
    if (options.error_rel > 0.0)
        text += fmt::format("; error {:.2g} % of the wanted {:.2g} %, {}",
                            100.0 * report.sampling.error_rel(), 100.0 * options.error_rel,
                            report.is_error_reached ? "reached" : "not reached");
    if (options.time_s > 0.0)
        text +=
            fmt::format("; {:.0f} of {:.0f} ms bought an error of {:.2g} %", 1e3 * report.time_s,
                        1e3 * options.time_s, 100.0 * report.sampling.error_rel());
    return text;
}

std::string named_device(const RenderReport& report) {
    return report.device_reason.empty()
               ? report.device
               : fmt::format("{} ({})", report.device, report.device_reason);
}

std::string stages_on_cpu(const RenderReport& report, const RenderOptions& options) {
    const std::string plan =
        options.time_s > 0.0 ? fmt::format("trials {:.2f} s, ", report.plan_s) : "";
    return fmt::format(
        "{}camera rays {:.2f} s, light sums {:.2f} s, samples {:.2f} s; {:.3g} M camera rays, "
        "{:.3g} M shadow rays, {:.3g} G multiply-adds",
        plan, report.camera_s, report.sums_s, report.visibility_s,
        1e-6 * static_cast<double>(report.camera_rays),
        1e-6 * static_cast<double>(report.shadow_rays), 1e-9 * report.multiply_adds);
}

std::string stages_on_card(const RenderReport& report) {
    std::string text;
    for (const PlannedPass& pass : report.plan.passes)
        for (const PassReport& cost : report.costs)
            if (cost.id == pass.id && cost.time_s > 0.0)
                text +=
                    fmt::format("{}{} {:.2f} s", text.empty() ? "" : ", ", pass.name, cost.time_s);
    return text;
}

/// What sigma leaves out on the graphics card.
std::string without(const RenderReport& report) {
    if (report.plan.device != Device::Gl)
        return "";
    std::string text;
    if (has_pass(report.plan, PassId::ShadowMaps))
        text += "; without the error of shadow maps";
    if (report.unmapped_pixels > 0)
        text += fmt::format("; {} pixels between a lamp's planes that its maps do not show are lit",
                            report.unmapped_pixels);
    return text;
}

}  // namespace

std::string summary(const RenderReport& report, const RenderOptions& options, glm::ivec2 size_px) {
    return fmt::format(
        "{} x {} px on {}; {}; load {:.2f} s, build {:.2f} s, {}; {}{}{}", size_px.x, size_px.y,
        named_device(report), passes(report, options), report.load_s, report.build_s,
        report.plan.device == Device::Gl ? stages_on_card(report) : stages_on_cpu(report, options),
        summary(report.sampling), goal(report, options),
        report.has_sigma_measured ? "; with the layer sigma_measured" : without(report));
}

std::string summary(const Noise& noise) {
    const std::string bias = noise.bias_mean_rel > 0.0 ? fmt::format("; bias {:.2g} % mean at most",
                                                                     100.0 * noise.bias_mean_rel)
                                                       : "";
    return fmt::format(
        "sampling sigma {:.2g} % mean, {:.2g} % or less on 95 % of the lit pixels, above 10 % on "
        "{:.2g} % of them{}",
        100.0 * noise.mean_rel, 100.0 * noise.p95_rel, 100.0 * noise.share_above_10_percent, bias);
}

Noise summarize_noise(const Layer& radiance,
                      const Layer& sigma,
                      const Layer* bias,
                      const Layer* depth) {
    constexpr float kFloor = 1e-3F;  // of the largest, as for relative RMS
    const auto luminance = [&](std::size_t i) {
        if (depth != nullptr && depth->values[i] == 0.0F)
            return 0.0F;
        return shared::luminance709(
            {radiance.values[3 * i], radiance.values[3 * i + 1], radiance.values[3 * i + 2]});
    };
    float brightest = 0.0F;
    for (std::size_t i = 0; i < sigma.values.size(); ++i)
        brightest = std::max(brightest, luminance(i));
    std::vector<float> lit;
    double bias_sum = 0.0;
    for (std::size_t i = 0; i < sigma.values.size(); ++i)
        if (luminance(i) > kFloor * brightest) {
            lit.push_back(sigma.values[i] / luminance(i));
            bias_sum += bias != nullptr ? static_cast<double>(bias->values[i] / luminance(i)) : 0.0;
        }
    Noise noise;
    if (lit.empty())
        return noise;
    const auto count = static_cast<double>(lit.size());
    for (const float relative : lit) {
        noise.mean_rel += static_cast<double>(relative) / count;
        noise.share_above_10_percent += relative > 0.1F ? 1.0 / count : 0.0;
    }
    noise.bias_mean_rel = bias_sum / count;
    const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.95 * count)) - 1;
    std::nth_element(lit.begin(), lit.begin() + rank, lit.end());
    noise.p95_rel = static_cast<double>(lit[static_cast<std::size_t>(rank)]);
    return noise;
}

namespace {

/// Those that were forced: "shadows=off color=on".
std::string forced_effects(const Effects& effects) {
    std::string text;
    const auto add = [&](const char* name, Switch wanted) {
        if (wanted != Switch::Auto)
            text += fmt::format("{}{}={}", text.empty() ? "" : " ", name,
                                wanted == Switch::On ? "on" : "off");
    };
    add("color", effects.color);
    add("shadows", effects.shadows);
    add("gloss", effects.gloss);
    add("tone-mapping", effects.tone_mapping);
    add("environment", effects.environment);
    return text;
}

}  // namespace

Provenance describe(const Scene& scene, const RenderOptions& options, const RenderReport& report) {
    const bool is_gl = report.plan.device == Device::Gl;
    Provenance provenance;
    provenance.program = program_version();
    provenance.command = "render";
    provenance.options = {{"width", fmt::format("{}", options.size_px.x)},
                          {"height", fmt::format("{}", options.size_px.y)},
                          {"camera", options.camera},
                          {"samples-per-pixel", fmt::format("{}", options.samples_per_pixel)},
                          {"sampler", name_of_sampler(options)},
                          {"samples", fmt::format("{}", options.samples)},
                          {"q", fmt::format("{}", options.q)},
                          {"sequence", options.sequence ? model::name_of(*options.sequence) : ""},
                          {"shift", model::name_of(options.shift)},
                          {"error", fmt::format("{}", options.error_rel)},
                          {"seed", fmt::format("{}", options.seed)},
                          {"device", is_gl ? "gl" : "cpu"},
                          {"effect", forced_effects(options.effects)},
                          {"sigma-measured", options.sigma_measured ? "true" : "false"}};
    if (options.shows_lamps)
        provenance.options.emplace_back("show-lamps", "true");
    if (options.time_s > 0.0)
        provenance.options.emplace_back(
            "time-ms", fmt::format("{} (passes and q depend on the clock)", 1e3 * options.time_s));
    if (is_gl && has_pass(report.plan, PassId::ShadowMaps)) {
        const ShadowMapOptions& maps = options.shadow_maps;
        provenance.options.emplace_back("shadow-maps", fmt::format("{}", maps.maps));
        provenance.options.emplace_back("shadow-map-px", fmt::format("{}", maps.map_px));
        provenance.options.emplace_back("shadow-taps", fmt::format("{}", maps.pcf_taps));
        provenance.options.emplace_back(
            "shadow-weights", options.shadow_weights == ShadowWeights::Pdis ? "pdis" : "shares");
    }
    if (report.plan.has_environment) {
        const EnvironmentOptions& around = options.environment;
        provenance.options.emplace_back("environment-method", name_of(around.method));
        provenance.options.emplace_back("environment-samples", fmt::format("{}", around.samples));
        provenance.options.emplace_back("environment-level", name_of(around.level));
        provenance.options.emplace_back("environment-anisotropic",
                                        around.is_anisotropic ? "true" : "false");
        provenance.options.emplace_back("environment-directions",
                                        fmt::format("{}", around.directions));
        provenance.options.emplace_back("environment-suns", fmt::format("{}", around.suns));
        provenance.options.emplace_back("environment-shift", around.is_shifted ? "true" : "false");
        provenance.inputs.push_back(describe_input(scene.environment->path));
    }
    std::set<std::string> seen;
    for (const LuminaireInstance& luminaire : scene.luminaires)
        if (luminaire.on && luminaire.dim > 0.0 && seen.insert(luminaire.path).second)
            provenance.inputs.push_back(describe_input(luminaire.path));
    provenance.figures = {
        {"sampling_sigma_mean_rel", report.sampling.mean_rel},
        {"sampling_sigma_p95_rel", report.sampling.p95_rel},
        {"sampling_sigma_share_above_10_percent", report.sampling.share_above_10_percent},
        {"bias_bound_mean_rel", report.sampling.bias_mean_rel},
        {"passes", report.passes},
        {"samples_per_pixel_and_lamp", report.samples},
        {"q_used", report.q}};
    if (is_gl)
        provenance.figures.push_back({"unmapped_pixels", report.unmapped_pixels});
    return provenance;
}

}  // namespace nearfield::render
