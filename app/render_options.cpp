// SPDX-License-Identifier: Apache-2.0
#include "app/render_options.h"

#include "app/options.h"
#include "app/sampler_options.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::app {
namespace {

void add_picture_options(CLI::App& sub, RenderCommand& c) {
    add_number(sub, "--width", c.options.size_px.x, 1, 16384, "PX", "pixels");
    add_number(sub, "--height", c.options.size_px.y, 0, 16384, "PX",
               "pixels; 0: from the camera's aspect ratio");
    sub.add_option("--camera", c.options.camera, "camera by name; the first by default")
        ->type_name("NAME");
    add_number(sub, "--samples-per-pixel", c.options.samples_per_pixel, 1, 1024, "N",
               "n x n strata: 1 (the pixel's center), 4, 9");
    add_number(sub, "--exposure-ev", c.display.exposure_ev, -100.0, 100.0, "EV",
               "of the PNG, at ISO 100; automatic by default");
    add_choice(sub, "--tonemap", c.display.tonemap,
               {{"filmic", render::ToneMap::Filmic}, {"papers", render::ToneMap::Papers}},
               "of the PNG: a film's curve, or 1 - exp(-L)");
}

void add_light_options(CLI::App& sub, RenderCommand& c) {
    add_choice(
        sub, "--sampler", c.options.sampler, sampler_choices(),
        "sum: light is summed without noise, shadows and gloss are sampled; the others "
        "sample all light, a shadow ray a sample; uniform, precomputed and pdis are there to "
        "compare with");
    add_number(
        sub, "--samples", c.options.samples, 0, render::kMostSamples, "K",
        "of a pixel and lamp; 0: 64, or as many as --error and --time-ms call for; with these "
        "at most K");
    add_number(sub, "--q", c.options.q, 0, 65536, "Q",
               "of sum: windows of at most Q texels, coarser and faster; 0: exact");
    add_choice(sub, "--sequence", c.options.sequence, sequence_choices(),
               "of samplers; by default the sampler's own");
    add_choice(sub, "--shift", c.options.shift, shift_choices(),
               "how pixels' samples differ: random and blue-noise give noise, constant and "
               "interleaved structured error");
    add_number(sub, "--seed", c.options.seed, std::uint32_t{0},
               std::numeric_limits<std::uint32_t>::max(), "N", "of all random numbers");
    add_number(sub, "--error", c.options.error_rel, 0.0, 0.999, "E",
               "add passes until the mean of sigma / radiance over lit pixels is E; 0: one pass");
    add_number(sub, "--time-ms", c.time_ms, 0.0, 1e9, "MS",
               "stop in time, loading included, writing not; 0: no limit");
}

void add_shadow_map_options(CLI::App& sub, RenderCommand& c) {
    render::ShadowMapOptions& maps = c.options.shadow_maps;
    add_number(sub, "--shadow-maps", maps.maps, 0, 65536, "N",
               "gl: of a lamp, at most; 0: one a cell of its U plane");
    add_number(sub, "--shadow-map-px", maps.map_px, 1, 16384, "PX",
               "gl: a shadow map's side; finer, nearer to traced shadows");
    add_choice(sub, "--shadow-taps", maps.pcf_taps, {{"1", 1}, {"4", 4}, {"9", 9}, {"16", 16}},
               "gl: texels of a map that a receiver is compared with; more, softer");
    add_choice(sub, "--shadow-weights", c.options.shadow_weights,
               {{"shares", render::ShadowWeights::Shares}, {"pdis", render::ShadowWeights::Pdis}},
               "gl, of sum: shares: each cell's own light by what its map shows; pdis: an image's "
               "light by the mean over its cells, to compare with");
}

void add_environment_options(CLI::App& sub, RenderCommand& c) {
    render::EnvironmentOptions& around = c.options.environment;
    add_choice(sub, "--environment", around.method,
               {{"filtered", render::EnvironmentMethod::Filtered},
                {"lights", render::EnvironmentMethod::Lights},
                {"resampled", render::EnvironmentMethod::Resampled},
                {"reference", render::EnvironmentMethod::Reference}},
               "how its light is found: filtered by harmonics and filtered samples, without noise; "
               "reference by --samples with a ray each; lights and resampled are there to compare "
               "with");
    add_number(sub, "--environment-samples", around.samples, 1, render::kMostSamples, "N",
               "filtered samples of a glossy pixel");
    add_number(
        sub, "--environment-error", around.error_rel, 0.0, 0.999, "E",
        "pixel by pixel as many of them, 8 to --environment-samples, as the relative error E "
        "is estimated to call for; 0: all of them");
    add_choice(sub, "--environment-level", around.level,
               {{"fis", render::FilterLevel::Fis},
                {"gems", render::FilterLevel::Gems},
                {"mfis", render::FilterLevel::Mfis},
                {"none", render::FilterLevel::None}},
               "how far they are blurred: as a paper does, or not at all, to compare with");
    sub.add_flag("--environment-anisotropic", around.is_anisotropic,
                 "several lookups along what a filtered sample stands for; slower");
    sub.add_flag("--environment-shift", around.is_shifted,
                 "other filtered samples for each pixel: noise in place of structured error");
    add_number(sub, "--environment-directions", around.directions, 0, 1 << 14, "N",
               "in which filtered light asks whether the sky is visible, 0: in none; of lights: "
               "how many");
    add_number(sub, "--environment-suns", around.suns, 0, 4096, "N",
               "of filtered: small bright parts of it that are summed one by one, at most");
    add_number(sub, "--environment-map-px", around.map_px, 1, 16384, "PX",
               "gl: a side of the shadow map of each direction");
    add_number(sub, "--environment-filter-px", around.filter_px, 0, 16, "PX",
               "gl: radius in which neighbors on the same surface share what they find hidden");
}

struct EffectName {
    const char* name;
    render::Switch render::Effects::*effect;
};
constexpr EffectName kEffects[] = {{"color", &render::Effects::color},
                                   {"shadows", &render::Effects::shadows},
                                   {"gloss", &render::Effects::gloss},
                                   {"tone-mapping", &render::Effects::tone_mapping},
                                   {"environment", &render::Effects::environment}};
constexpr std::pair<const char*, render::Switch> kSwitches[] = {
    {"auto", render::Switch::Auto}, {"on", render::Switch::On}, {"off", render::Switch::Off}};

struct EffectChoice {
    render::Switch render::Effects::*effect;
    render::Switch wanted;
};

/// "shadows=off"; nothing where it is anything else.
std::optional<EffectChoice> parse_effect(const std::string& text) {
    for (const EffectName& known : kEffects)
        for (const auto& [word, wanted] : kSwitches)
            if (text == fmt::format("{}={}", known.name, word))
                return EffectChoice{known.effect, wanted};
    return std::nullopt;
}

std::string effect_names() {
    std::string names;
    for (const EffectName& known : kEffects)
        names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
    return names;
}

void add_effect_options(CLI::App& sub, RenderCommand& c) {
    CLI::Option* effect = sub.add_option_function<std::vector<std::string>>(
        "--effect",
        [&c](const std::vector<std::string>& texts) {
            for (const std::string& text : texts)
                if (const auto choice = parse_effect(text))
                    c.options.effects.*choice->effect = choice->wanted;
        },
        fmt::format("of {}: on and off force what is otherwise computed only if the scene calls "
                    "for it; may be given again",
                    effect_names()));
    effect->type_name("NAME=auto|on|off")->allow_extra_args(false);
    add_checks(effect, fmt::format("NAME=auto, =on or =off, NAME one of {}", effect_names()),
               [](const std::string& text) { return parse_effect(text).has_value(); });
    sub.add_flag("--explain", c.explain,
                 "print what was computed and what not, why, and what each pass took");
}

}  // namespace

void add_render_options(CLI::App& sub, RenderCommand& c) {
    sub.add_option("scene", c.scene, "scene, .gltf or .glb (docs/scenes.md)")
        ->required()
        ->type_name("FILE");
    add_checks(add_output(sub, c.output, "picture to write, NAME.exr"), "NAME.exr",
               [](const std::string& path) { return path.ends_with(".exr"); });
    sub.add_option("--png", c.png, "tone-mapped picture; by default NAME.png")->type_name("FILE");
    add_choice(
        sub, "--device", c.options.device,
        {{"auto", render::Device::Auto}, {"cpu", render::Device::Cpu}, {"gl", render::Device::Gl}},
        "what computes; auto: OpenGL where there is a context, else the CPU");
    sub.add_option("--compare", c.compare,
                   "picture of the same size, NAME.exr: print how far this one is from it, and add "
                   "the layer error")
        ->type_name("FILE");
    add_picture_options(sub, c);
    add_light_options(sub, c);
    add_effect_options(sub, c);
    add_environment_options(sub, c);
    add_shadow_map_options(sub, c);
    add_number(sub, "--threads", c.options.threads, 0, 4096, "N",
               "0: all cores; the picture is the same");
    sub.add_flag("--sigma-measured", c.options.sigma_measured,
                 "add the layer sigma_measured, from the lamps' own sigmas; slow");
    sub.add_flag(
        "--show-lamps", c.options.shows_lamps,
        "show lamps themselves where the camera looks into them, in the picture and as the "
        "layer lamps");
}

}  // namespace nearfield::app
