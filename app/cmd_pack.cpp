// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "formats/files/luminaire.h"
#include "formats/files/repair.h"
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
    bool repair = false;
};

void run(const PackCommand& command) {
    const double start_s = now_s();
    check_outputs({command.output.path}, {command.input});
    LightField lightfield =
        command.repair ? read_broken_lightfield(command.input) : read_lightfield(command.input);
    const Repairs repairs = command.repair ? repair(lightfield) : Repairs{};
    // What made the light field stays on record: its figures, and its file as this file's input.
    Provenance provenance;
    provenance.program = program_version();
    provenance.command = "pack";
    provenance.options = {{"lean", command.lean ? "true" : "false"},
                          {"repair", command.repair ? "true" : "false"}};
    provenance.inputs = {describe_input(command.input)};
    provenance.inputs.insert(provenance.inputs.end(), lightfield.provenance.inputs.begin(),
                             lightfield.provenance.inputs.end());
    provenance.figures = lightfield.provenance.figures;
    if (command.repair)
        provenance.figures.emplace_back("repaired_values", static_cast<double>(repairs.count()));
    lightfield.provenance = std::move(provenance);

    const Luminaire luminaire = model::pack(std::move(lightfield), command.lean);
    const RunRecord run = record_run(start_s);
    write_luminaire(luminaire, command.output.stored(run), command.output.path);
    const std::size_t slabs = luminaire.lightfield.slabs.size();
    if (command.repair)
        say(fmt::format(
            "{}: {} values repaired: {} negative and {} NaN now 0, {} infinite now their image's "
            "largest\n",
            command.input, repairs.count(), repairs.negative, repairs.not_a_number,
            repairs.infinite));
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
    sub->add_flag(
        "--repair", c->repair,
        "set NaN and negative values to 0 and infinite ones to their image's largest, and "
        "say how many; without it such files are refused");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
