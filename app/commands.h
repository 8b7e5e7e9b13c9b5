// SPDX-License-Identifier: Apache-2.0
/// The sub-commands. Each add_* declares one with its options; CLI11 runs it when it was called.
#pragma once

namespace CLI {
class App;
}

namespace nearfield::app {

void add_demo(CLI::App& app);
void add_simulate(CLI::App& app);
void add_convert(CLI::App& app);
void add_export(CLI::App& app);
void add_pack(CLI::App& app);
void add_info(CLI::App& app);
void add_compare(CLI::App& app);
void add_farfield(CLI::App& app);
void add_probe(CLI::App& app);
void add_render(CLI::App& app);
void add_view(CLI::App& app);
void add_bench(CLI::App& app);
void add_lab(CLI::App& app);
void add_devices(CLI::App& app);
void add_preview(CLI::App& app);
void add_capture(CLI::App& app);
void add_calibrate(CLI::App& app);
void add_fit(CLI::App& app);

}  // namespace nearfield::app
