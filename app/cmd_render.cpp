// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/render_options.h"
#include "render/compare.h"
#include "render/device.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace nearfield::app {
namespace {

void check_files(const RenderCommand& command, const Scene& scene) {
    std::vector<std::string> inputs = {command.scene};
    for (const LuminaireInstance& lamp : scene.luminaires)
        inputs.push_back(lamp.path);
    if (scene.environment)
        inputs.push_back(scene.environment->path);
    if (!command.compare.empty())
        inputs.push_back(command.compare);
    check_outputs({command.output.path, command.png}, inputs);
}

/// "3 passes, error 2.1 % -> 1 %".
std::string so_far(const render::RenderProgress& at, const render::RenderOptions& options) {
    if (at.passes == 0)
        return "";
    std::string text = fmt::format("{} pass{}, error {:.2g} %", at.passes,
                                   at.passes == 1 ? "" : "es", 100.0 * at.error_rel);
    if (options.error_rel > 0.0)
        text += fmt::format(" -> {:.2g} %", 100.0 * options.error_rel);
    return text;
}

bool has_png(const RenderCommand& command) {
    return command.options.effects.tone_mapping != render::Switch::Off;
}

void complete(RenderCommand& command) {
    command.options.time_s = 1e-3 * command.time_ms;
    if (!has_png(command) && !command.png.empty())
        throw CLI::ValidationError("--png", "expected no --effect tone-mapping=off beside it");
    command.options.is_displayed = has_png(command);
    check_options([&] { render::check(command.options); });
    if (has_png(command) && command.png.empty())
        command.png = std::filesystem::path(command.output.path).replace_extension(".png").string();
}

/// Tone-maps and writes the PNG. Returns the exposure.
double write_display(const RenderCommand& command,
                     const Picture& picture,
                     render::RenderReport& report) {
    const double start_s = now_s();
    const render::Display display = render::display(picture, command.display);
    report.costs.push_back(
        {render::PassId::ToneMapping, now_s() - start_s, static_cast<double>(display.srgb.size())});
    write_png(display.srgb, picture.size_px, command.png);
    return display.exposure_ev;
}

/// Adds the layer that says where the picture differs, and says how much.
void add_comparison(const RenderCommand& command, Picture& picture) {
    const render::Comparison found =
        render::compare_pictures(picture, read_picture(command.compare));
    picture.provenance.inputs.push_back(describe_input(command.compare));
    say(fmt::format("{}: against {}: {}\n", command.output.path, command.compare,
                    render::summary(found)));
}

void run(RenderCommand command) {
    const double start_s = now_s();
    complete(command);
    const Scene scene = read_scene(command.scene);
    check_files(command, scene);
    for (const std::string& note : scene.notes)
        say(fmt::format("{}: {}\n", command.scene, note));
    ProgressLine progress("render");
    render::RenderHooks hooks;
    hooks.progress = [&](const render::RenderProgress& at) {
        progress.update(at.fraction, so_far(at, command.options));
    };
    auto [picture, report] = render::render(scene, command.options, hooks);
    progress.finish();

    picture.provenance = render::describe(scene, command.options, report);
    picture.provenance.inputs.push_back(describe_input(command.scene));
    if (!command.compare.empty())
        add_comparison(command, picture);
    const RunRecord run = nearfield::finish_run(start_s, report.threads);
    write_picture(picture, command.output.stored(run), command.output.path);
    say(fmt::format("{}: {}\n", command.output.path,
                    render::summary(report, command.options, picture.size_px)));
    if (has_png(command))
        say(fmt::format("{}: exposure {:.2f} EV; {}\n", command.png,
                        write_display(command, picture, report), cost(run)));
    else
        say(fmt::format("{}: {}\n", command.output.path, cost(run)));
    if (command.explain)
        print(render::explain(report));
    if (!report.is_error_reached)
        throw CLI::RuntimeError(3);
}

}  // namespace

void add_render(CLI::App& app) {
    auto c = std::make_shared<RenderCommand>();
    CLI::App* sub =
        add_command(app, "render", "Renders a glTF scene lit by its luminaires",
                    {"nearfield render out/scene.gltf -o picture.exr",
                     "nearfield render out/scene.gltf -o picture.exr --width 1280 --exposure-ev 4",
                     "nearfield render out/scene.gltf -o picture.exr --error 0.01",
                     "nearfield render out/scene.gltf -o preview.exr --time-ms 500",
                     "nearfield render out/scene.gltf -o gl.exr --device gl --compare picture.exr",
                     "nearfield render out/scene.gltf -o picture.exr --explain"});
    add_render_options(*sub, *c);
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
