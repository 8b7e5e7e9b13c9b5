// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/convert_options.h"
#include "app/options.h"
#include "app/progress.h"
#include "formats/photometry/photometric_file.h"
#include "formats/rays/report.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

namespace nearfield::app {
namespace {

void convert_rays(ConvertCommand& command) {
    const double start_s = now_s();
    rays::RaySet set = rays::read_rays(command.input, command.read);
    if (command.flux)
        rays::scale_to(set, *command.flux);
    for (const std::string& note : set.notes)
        say(fmt::format("{}: {}\n", command.input, note));
    ProgressLine progress("convert");
    command.options.progress = [&](double fraction) { progress.update(fraction); };
    rays::Conversion result = rays::to_lightfield(set, command.options);
    progress.finish();
    say(rays::summary(set, result.report));
    if (!result.report.is_good_enough() && !command.allow_drop) {
        say(fmt::format("{}: not written: over 2 % of the flux is lost; --allow-drop writes it\n",
                        command.output.path));
        throw CLI::RuntimeError(3);
    }
    result.lightfield.provenance =
        rays::describe(set, command.read, command.options, command.flux, result.report);
    result.lightfield.provenance.inputs = {describe_input(command.input)};
    const RunRecord run = record_run(start_s);
    write_lightfield(result.lightfield, command.output.stored(run), command.output.path);
    say(fmt::format("{}: {}\n", command.output.path, cost(run)));
}

void run(const CLI::App& sub, ConvertCommand& command) {
    check_options([&] { rays::check(command.options); });
    check_outputs({command.output.path}, {command.input});
    const bool is_photometry = photometry::holds_photometry(command.input);
    refuse_options_of_others(sub, is_photometry ? ConvertInput::Photometry : ConvertInput::Rays);
    if (is_photometry)
        convert_photometry(command);
    else
        convert_rays(command);
}

}  // namespace

void add_convert(CLI::App& app) {
    auto c = std::make_shared<ConvertCommand>();
    CLI::App* sub = add_command(
        app, "convert", "Makes a light field from a ray file or a photometric file",
        {"nearfield convert led.tm25ray -o led.lightfield.exr",
         "nearfield convert led.tm25ray -o led.lightfield.exr --slabs 5 --grid 13x11 --no-color",
         "nearfield convert street.ies -o street.lightfield.exr --opening-mm 400 250"});
    add_convert_options(*sub, *c);
    sub->callback([c, sub] { run(*sub, *c); });
}

}  // namespace nearfield::app
