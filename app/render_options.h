// SPDX-License-Identifier: Apache-2.0
/// The options of `nearfield render`.
#pragma once

#include "app/output.h"
#include "render/display.h"
#include "render/options.h"

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace nearfield::app {

struct RenderCommand {
    std::string scene, png, compare;
    Output output;
    double time_ms = 0;  // 0: no limit
    bool explain = false;
    render::RenderOptions options;
    render::DisplayOptions display;
};

/// Declares them; the command must outlive the parsing.
void add_render_options(CLI::App& sub, RenderCommand& command);

}  // namespace nearfield::app
