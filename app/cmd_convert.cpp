// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "formats/model/profile.h"
#include "formats/rays/report.h"
#include "formats/rays/tm25.h"
#include "formats/rays/to_lightfield.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <memory>

namespace nearfield::app {
namespace {

struct ConvertCommand {
    std::string input;
    Output output;
    rays::ReadOptions read;
    rays::ConvertOptions options;
    std::optional<double> flux;
    bool allow_drop = false;
};

void run(ConvertCommand& command) {
    const double start_s = now_s();
    check_options([&] { rays::check(command.options); });
    if (command.options.grid && command.options.texels)
        check_size(*command.options.grid, *command.options.texels);
    check_outputs({command.output.path}, {command.input});
    rays::RaySet set = rays::read_tm25(command.input, command.read);
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

}  // namespace

void add_convert(CLI::App& app) {
    constexpr double kFar_mm = 1e6;
    auto c = std::make_shared<ConvertCommand>();
    CLI::App* sub = add_command(
        app, "convert", "Makes a light field from a TM-25 ray file",
        {"nearfield convert led.tm25ray -o led.lightfield.exr",
         "nearfield convert led.tm25ray -o led.lightfield.exr --slabs 5 --grid 13x11 --no-color"});
    sub->add_option("rays", c->input, "ray file, .tm25ray (docs/ray_files.md)")
        ->required()
        ->type_name("FILE");
    add_output(*sub, c->output, "light field to write, NAME.lightfield.exr");
    const auto plane = [&](const char* name, std::optional<double>& z_mm, const char* help) {
        add_number(*sub, name, z_mm, -kFar_mm, kFar_mm, "MM", help);
    };
    plane("--u-plane-mm", c->options.u_plane_mm,
          "basis plane of the slab towards +z, in the file's z; automatic by default");
    plane("--s-plane-mm", c->options.s_plane_mm,
          "image plane of the slab towards +z, in the file's z; automatic by default");
    add_size(*sub, "--grid", c->options.grid,
             "basis functions of every slab; by default automatic");
    add_size(*sub, "--texels", c->options.texels, "texels of every image; by default automatic");
    add_choice(*sub, "--slabs", c->options.slabs,
               {{"1", std::optional(1)}, {"5", std::optional(5)}, {"6", std::optional(6)}},
               "directions: z > 0, all but mainly -z, all; by default the fewest that lose < 1 %");
    add_choice(*sub, "--basis", c->options.basis, same_words(model::profile_names()),
               "shape of the basis functions");
    add_number(*sub, "--flux-lm,--flux-w", c->flux, 1e-9, 1e12, "FLUX",
               "scale the rays to this total");
    sub->add_flag_callback(
        "--no-color", [c] { c->options.color = false; }, "one channel Y even if rays have color");
    sub->add_flag("--keep-ray-flux", c->read.keep_ray_flux,
                  "keep the rays' own sum of flux where the file's header states another");
    sub->add_flag("--keep-radiometric", c->read.keep_radiometric,
                  "keep watts where wavelengths would give lumens");
    sub->add_flag("--allow-drop", c->allow_drop, "write even if over 2 % of the flux is lost");
    add_number(*sub, "--seed", c->options.seed, std::uint64_t{0},
               std::numeric_limits<std::uint64_t>::max(), "N", "of cross-validation");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
