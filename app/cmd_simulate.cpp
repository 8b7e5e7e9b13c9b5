// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "formats/files/atomic_file.h"
#include "formats/model/profile.h"
#include "sample_data/simulate.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

namespace nearfield::app {
namespace {

enum class Lamp { Headlight, Reference };

struct SimulateCommand {
    Lamp lamp = Lamp::Headlight;
    std::string receivers;
    Output output;
    sample_data::SimulateOptions options;
};

LightField simulate(const SimulateCommand& command) {
    if (command.lamp == Lamp::Reference)
        return sample_data::simulate_reference();
    ProgressLine progress("simulate");
    const auto update = [&](double fraction) { progress.update(fraction); };
    return sample_data::simulate_headlight(command.options, update).lightfield;
}

void run(const SimulateCommand& command) {
    const double start_s = now_s();
    check_size(command.options.grid, command.options.texels);
    check_outputs({command.output.path, command.receivers}, {});
    if (!command.receivers.empty())
        write_file(sample_data::receivers_csv(), command.receivers);
    const LightField lightfield = simulate(command);
    const RunRecord run = record_run(start_s);
    write_lightfield(lightfield, command.output.stored(run), command.output.path);
    for (const auto& [name, value] : lightfield.provenance.figures)
        say(fmt::format("{}: {:.6g}\n", name, value));
    say(fmt::format("{}: {}\n", command.output.path, cost(run)));
}

}  // namespace

void add_simulate(CLI::App& app) {
    auto c = std::make_shared<SimulateCommand>();
    CLI::App* sub = add_command(
        app, "simulate", "Makes a synthetic lamp whose radiance is known",
        {"nearfield simulate headlight -o headlight.lightfield.exr",
         "nearfield simulate reference -o reference.lightfield.exr --receivers points.csv"});
    add_choice(
        *sub, "lamp", c->lamp, {{"headlight", Lamp::Headlight}, {"reference", Lamp::Reference}},
        "headlight, or reference, which takes none of the options from --delta-m to --refine")
        ->required()
        ->default_str("");
    add_output(*sub, c->output, "light field to write, NAME.lightfield.exr");
    add_number(*sub, "--delta-m", c->options.delta_m, 0.05, 100.0, "M", "distance of the planes");
    add_size(*sub, "--grid", c->options.grid, "basis functions over the lens");
    add_size(*sub, "--texels", c->options.texels, "texels of every image");
    add_choice(*sub, "--basis", c->options.basis, same_words(model::profile_names()),
               "shape of the basis functions");
    add_choice(*sub, "--weighting", c->options.weighting,
               {{"irradiance", Weighting::Irradiance}, {"radiance", Weighting::Radiance}},
               "what the coefficients are a density of");
    add_choice(*sub, "--channels", c->options.channels, {{"3", 3}, {"1", 1}}, "RGB, or Y alone");
    add_seed(*sub, c->options.seed, "of the facets' pattern");
    add_number(*sub, "--refine", c->options.refine, 1, 8, "N", "multiplies quadrature nodes");
    sub->add_option("--receivers", c->receivers,
                    "also write the reference lamp's receivers, CSV for probe --points")
        ->type_name("FILE");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
