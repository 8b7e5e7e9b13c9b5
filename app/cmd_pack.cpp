// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "formats/files/luminaire.h"
#include "formats/model/tables.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>
#include <thread>
#include <utility>

namespace nearfield::app {
namespace {

struct PackCommand {
    std::string input, output;
    bool lean = false, reproducible = false;
};

void run(const PackCommand& command) {
    const double start_s = now_s();
    LightField lightfield = read_lightfield(command.input);
    // What made the light field stays on record: its figures, and its file as this file's input.
    Provenance provenance;
    provenance.program = program_version();
    provenance.command = "pack";
    provenance.options = {{"lean", command.lean ? "true" : "false"}};
    provenance.inputs = {describe_input(command.input)};
    provenance.inputs.insert(provenance.inputs.end(), lightfield.provenance.inputs.begin(),
                             lightfield.provenance.inputs.end());
    provenance.figures = lightfield.provenance.figures;
    lightfield.provenance = std::move(provenance);

    const Luminaire luminaire = model::pack(std::move(lightfield), command.lean);
    const RunRecord record =
        finish_run(start_s, static_cast<int>(std::thread::hardware_concurrency()));
    write_luminaire(luminaire, command.reproducible ? std::nullopt : std::optional(record),
                    command.output);
    fmt::print(stderr, "{}: {} slab{}, {}; {:.2f} s, peak memory {:.0f} MiB\n", command.output,
               luminaire.lightfield.slabs.size(), luminaire.lightfield.slabs.size() == 1 ? "" : "s",
               command.lean ? "lean" : "with tables", record.time_s, record.peak_memory_mib);
}

}  // namespace

void add_pack(CLI::App& app) {
    auto c = std::make_shared<PackCommand>();
    CLI::App* sub = app.add_subcommand("pack", "Makes a light field ready to render");
    sub->add_option("lightfield", c->input, "NAME.lightfield.exr")->required();
    sub->add_option("-o,--output", c->output, "NAME.luminaire.exr")->required();
    sub->add_flag("--lean", c->lean,
                  "leave out the tables for samplers: smaller, and a loader builds them faster");
    sub->add_flag("--reproducible", c->reproducible, "leave date, time and memory out");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
