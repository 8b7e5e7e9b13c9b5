// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "formats/files/luminaire.h"
#include "formats/model/tables.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>
#include <utility>

namespace nearfield::app {
namespace {

struct PackCommand {
    std::string input;
    Output output;
    bool lean = false;
};

void run(const PackCommand& command) {
    const double start_s = now_s();
    check_outputs({command.output.path}, {command.input});
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
    const RunRecord run = record_run(start_s);
    write_luminaire(luminaire, command.output.stored(run), command.output.path);
    const std::size_t slabs = luminaire.lightfield.slabs.size();
    say(fmt::format("{}: {} slab{}, {}; {}\n", command.output.path, slabs, slabs == 1 ? "" : "s",
                    command.lean ? "lean" : "with tables", cost(run)));
}

}  // namespace

void add_pack(CLI::App& app) {
    auto c = std::make_shared<PackCommand>();
    CLI::App* sub =
        add_command(app, "pack", "Makes a light field ready to render",
                    {"nearfield pack headlight.lightfield.exr -o headlight.luminaire.exr",
                     "nearfield pack headlight.lightfield.exr -o headlight.luminaire.exr --lean"});
    sub->add_option("lightfield", c->input, "light field, NAME.lightfield.exr")
        ->required()
        ->type_name("FILE");
    add_output(*sub, c->output, "luminaire to write, NAME.luminaire.exr");
    sub->add_flag("--lean", c->lean,
                  "leave out the tables for samplers: smaller, and a loader builds them faster");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
