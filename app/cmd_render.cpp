// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "render/cpu/render.h"
#include "render/display.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>

namespace nearfield::app {
namespace {

enum class Device { Cpu };

struct RenderCommand {
    std::string scene, png;
    Output output;
    Device device = Device::Cpu;
    render::RenderOptions options;
    render::DisplayOptions display;
};

void check_files(const RenderCommand& command, const Scene& scene) {
    std::vector<std::string> inputs = {command.scene};
    for (const LuminaireInstance& lamp : scene.luminaires)
        inputs.push_back(lamp.path);
    check_outputs({command.output.path, command.png}, inputs);
}

void run(RenderCommand command) {
    const double start_s = now_s();
    check_options([&] { render::check(command.options); });
    if (command.png.empty())
        command.png = std::filesystem::path(command.output.path).replace_extension(".png").string();
    const Scene scene = read_scene(command.scene);
    check_files(command, scene);
    for (const std::string& note : scene.notes)
        say(fmt::format("{}: {}\n", command.scene, note));
    ProgressLine progress("render");
    auto [picture, report] =
        render::render(scene, command.options, [&](double fraction) { progress.update(fraction); });
    progress.finish();

    picture.provenance = render::describe(scene, command.options, report);
    picture.provenance.inputs.push_back(describe_input(command.scene));
    const RunRecord run = nearfield::finish_run(start_s, report.threads);
    write_picture(picture, command.output.stored(run), command.output.path);
    const render::Display display = render::display(picture, command.display);
    write_png(display.srgb, picture.size_px, command.png);
    say(fmt::format("{}: {}\n", command.output.path, render::summary(report, picture.size_px)));
    say(fmt::format("{}: exposure {:.2f} EV; {}\n", command.png, display.exposure_ev, cost(run)));
}

}  // namespace

void add_render(CLI::App& app) {
    auto c = std::make_shared<RenderCommand>();
    CLI::App* sub = add_command(
        app, "render", "Renders a glTF scene lit by its luminaires",
        {"nearfield render out/scene.gltf -o picture.exr",
         "nearfield render out/scene.gltf -o picture.exr --width 1280 --exposure-ev 4"});
    const auto number = [&](const char* name, int& value, int least, int most, const char* unit,
                            const char* help) {
        add_number(*sub, name, value, least, most, unit, help);
    };
    sub->add_option("scene", c->scene, "scene, .gltf or .glb (docs/scenes.md)")
        ->required()
        ->type_name("FILE");
    add_checks(add_output(*sub, c->output, "picture to write, NAME.exr"), "NAME.exr",
               [](const std::string& path) { return path.ends_with(".exr"); });
    sub->add_option("--png", c->png, "tone-mapped picture; by default NAME.png")->type_name("FILE");
    add_choice(*sub, "--device", c->device, {{"cpu", Device::Cpu}}, "what computes");
    number("--width", c->options.size_px.x, 1, 16384, "PX", "pixels");
    number("--height", c->options.size_px.y, 0, 16384, "PX",
           "pixels; 0: from the camera's aspect ratio");
    sub->add_option("--camera", c->options.camera, "camera by name; the first by default")
        ->type_name("NAME");
    add_number(*sub, "--exposure-ev", c->display.exposure_ev, -100.0, 100.0, "EV",
               "of the PNG, at ISO 100; automatic by default");
    add_choice(*sub, "--tonemap", c->display.tonemap,
               {{"filmic", render::ToneMap::Filmic}, {"papers", render::ToneMap::Papers}},
               "of the PNG: a film's curve, or 1 - exp(-L)");
    number("--threads", c->options.threads, 0, 4096, "N", "0: all cores; the picture is the same");
    add_number(*sub, "--seed", c->options.seed, std::uint32_t{0},
               std::numeric_limits<std::uint32_t>::max(), "N", "of all random numbers");
    number("--visibility-samples", c->options.visibility_samples, 2, 1 << 20, "N",
           "shadow rays of a pixel and lamp");
    number("--samples-per-pixel", c->options.samples_per_pixel, 1, 1024, "N",
           "n x n strata: 1 (the pixel's center), 4, 9");
    sub->add_flag("--sigma-measured", c->options.sigma_measured,
                  "add the layer sigma_measured, from the lamps' own sigmas; slow");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
