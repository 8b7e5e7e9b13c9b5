// SPDX-License-Identifier: Apache-2.0
#include "acquire/aravis_camera.h"
#include "acquire/serial_line.h"
#include "acquire/usbtmc.h"
#include "acquire/v4l2_camera.h"
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace nearfield::app {
namespace {

std::string row(const std::string& protocol,
                const std::string& address,
                const std::string& model,
                const std::string& serial,
                const std::string& id) {
    return fmt::format("{:<12} {:<18} {:<24} {:<20} {}\n", protocol, address, model, serial, id);
}

void list_devices() {
    std::vector<acquire::FoundCamera> cameras = acquire::find_cameras();
    const std::vector<acquire::FoundCamera> v4l2 = acquire::find_v4l2_cameras();
    cameras.insert(cameras.end(), v4l2.begin(), v4l2.end());
    std::string table;
    for (const acquire::FoundCamera& camera : cameras)
        table += row(camera.protocol, camera.address, camera.model, camera.serial, camera.id);
    for (const acquire::FoundInstrument& instrument : acquire::find_instruments())
        table +=
            row("USBTMC", instrument.address, instrument.model, instrument.serial, instrument.id);
    for (const std::string& line : acquire::find_serial_lines())
        table += row("serial", line, "", "", line);
    if (table.empty())
        return say(
            "no camera or instrument answers; a GigE Vision camera must be on a network of this "
            "machine, and no firewall between (UDP 3956); USB devices need permissions "
            "(docs/bench.md)\n");
    print(row("protocol", "address", "model", "serial", "id") + table);
}

}  // namespace

void add_devices(CLI::App& app) {
    add_command(app, "devices", "Lists cameras and instruments that answer", {"nearfield devices"})
        ->callback(list_devices);
}

}  // namespace nearfield::app
