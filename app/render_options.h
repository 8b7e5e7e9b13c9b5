// SPDX-License-Identifier: Apache-2.0
/// The options of `nearfield render`.
#pragma once

#include "app/output.h"
#include "render/cpu/render.h"
#include "render/display.h"

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace nearfield::app {

enum class Device { Cpu };

struct RenderCommand {
    std::string scene, png;
    Output output;
    Device device = Device::Cpu;
    double time_ms = 0;  // 0: no limit
    render::RenderOptions options;
    render::DisplayOptions display;
};

/// Declares them; the command must outlive the parsing.
void add_render_options(CLI::App& sub, RenderCommand& command);

}  // namespace nearfield::app
