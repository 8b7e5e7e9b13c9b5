// SPDX-License-Identifier: Apache-2.0
#include "acquire/aravis_camera.h"
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace nearfield::app {
namespace {

void list_cameras() {
    const std::vector<acquire::FoundCamera> found = acquire::find_cameras();
    if (found.empty())
        return say(
            "no camera answers; a GigE Vision camera must be on a network of this machine, and no "
            "firewall "
            "between (UDP 3956)\n");
    std::string table = fmt::format("{:<12} {:<16} {:<20} {:<20} {}\n", "protocol", "address",
                                    "model", "serial", "id");
    for (const acquire::FoundCamera& camera : found)
        table += fmt::format("{:<12} {:<16} {:<20} {:<20} {}\n", camera.protocol, camera.address,
                             camera.model, camera.serial, camera.id);
    print(table);
}

}  // namespace

void add_devices(CLI::App& app) {
    add_command(app, "devices", "Lists the cameras that answer", {"nearfield devices"})
        ->callback(list_cameras);
}

}  // namespace nearfield::app
