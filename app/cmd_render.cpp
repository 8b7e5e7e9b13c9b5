// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/progress.h"
#include "formats/files/error.h"
#include "render/cpu/render.h"
#include "render/display.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>

namespace nearfield::app {
namespace {

struct RenderCommand {
    std::string scene, output, png, device = "cpu";
    render::RenderOptions options;
    render::DisplayOptions display;
    bool reproducible = false;
};

void run(const RenderCommand& command) {
    const double start_s = now_s();
    if (command.device != "cpu")
        throw Error{"no such device", "--device", "cpu", "'" + command.device + "', not built in"};
    const Scene scene = read_scene(command.scene);
    for (const std::string& note : scene.notes)
        fmt::print(stderr, "{}: {}\n", command.scene, note);
    ProgressLine progress("render");
    auto [picture, report] =
        render::render(scene, command.options, [&](double fraction) { progress.update(fraction); });
    progress.finish();

    picture.provenance = render::describe(scene, command.options, report);
    picture.provenance.inputs.push_back(describe_input(command.scene));
    const RunRecord record = finish_run(start_s, report.threads);
    write_picture(picture, command.reproducible ? std::nullopt : std::optional(record),
                  command.output);
    const render::Display display = render::display(picture, command.display);
    const auto beside = std::filesystem::path(command.output).replace_extension(".png").string();
    write_png(display.srgb, picture.size_px, command.png.empty() ? beside : command.png);
    fmt::print(stderr, "{}: {}\n", command.output, render::summary(report, picture.size_px));
    fmt::print(stderr, "exposure {:.2f} EV; {:.2f} s on {} threads, peak memory {:.0f} MiB\n",
               display.exposure_ev, record.time_s, record.threads, record.peak_memory_mib);
}

}  // namespace

void add_render(CLI::App& app) {
    auto c = std::make_shared<RenderCommand>();
    CLI::App* sub = app.add_subcommand("render", "Renders a glTF scene lit by its luminaires");
    const auto add = [&](const char* name, auto& value, const char* help) {
        return sub->add_option(name, value, help)->capture_default_str();
    };
    add("scene", c->scene, ".gltf or .glb (docs/scenes.md)")->required();
    add("-o,--output", c->output, "EXR with radiance and further layers")->required();
    add("--png", c->png, "tone-mapped picture; beside the output by default");
    add("--device", c->device, "cpu");
    add("--width", c->options.size_px.x, "pixels");
    add("--height", c->options.size_px.y, "pixels; 0: by the camera's aspect ratio");
    add("--camera", c->options.camera, "by name; the first by default");
    sub->add_option("--exposure-ev", c->display.exposure_ev, "at ISO 100; automatic by default");
    const std::map<std::string, render::ToneMap> tonemaps{{"filmic", render::ToneMap::Filmic},
                                                          {"papers", render::ToneMap::Papers}};
    sub->add_option("--tonemap", c->display.tonemap, "filmic (default) or papers")
        ->transform(CLI::CheckedTransformer(tonemaps));
    add("--threads", c->options.threads, "0: all cores");
    add("--seed", c->options.seed, "of all random numbers");
    add("--visibility-samples", c->options.visibility_samples, "shadow rays a pixel and lamp");
    add("--samples-per-pixel", c->options.samples_per_pixel, "n*n strata; 1: the pixel's center");
    sub->add_flag("--reproducible", c->reproducible, "leave date, time and memory out");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
