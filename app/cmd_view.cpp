// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/viewer/run.h"

#include <CLI/CLI.hpp>

#include <memory>

namespace nearfield::app {

void add_view(CLI::App& app) {
    auto c = std::make_shared<viewer::ViewerOptions>();
    CLI::App* sub = add_command(
        app, "view", "Shows a scene in a window, and edits its luminaires",
        {"nearfield view out/scene.gltf", "nearfield view headlight.luminaire.exr",
         "nearfield view out/scene.gltf --camera driver --screenshot driver.png --exit"});
    sub->add_option("scene", c->path,
                    "scene, .gltf or .glb (docs/scenes.md), or a luminaire, which is shown in a "
                    "scene of its own")
        ->required()
        ->type_name("FILE");
    sub->add_option("--add", c->lamps, "luminaire to add; may be given again")
        ->type_name("FILE")
        ->allow_extra_args(false);
    add_size(*sub, "--size", c->size_px, "of the window, pixels; by default as it was left");
    sub->add_option("--camera", c->camera, "camera by name; the first by default")
        ->type_name("NAME");
    add_number(*sub, "--dial", c->dial, 0, static_cast<int>(viewer::dials().size()) - 1, "N",
               "accuracy, from fast to exact; 3 is what render --device gl does");
    add_number(*sub, "--exposure-ev", c->exposure_ev, -100.0, 100.0, "EV",
               "at ISO 100; automatic by default");
    sub->add_option("--screenshot", c->screenshot,
                    "write the refined picture, NAME.png, without panels")
        ->type_name("FILE");
    sub->add_option("--window-screenshot", c->window_screenshot,
                    "write what the window shows then, NAME.png, with panels")
        ->type_name("FILE");
    sub->add_flag("--exit", c->exits, "end once the picture is refined and written");
    sub->add_flag("!--forget", c->remembers, "neither use nor keep the window's place");
    sub->add_option("--trace", c->trace,
                    "write what is shown when, and where widgets are, as JSON lines")
        ->type_name("FILE");
    sub->callback([c] { viewer::run_viewer(*c); });
}

}  // namespace nearfield::app
