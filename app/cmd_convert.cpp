// SPDX-License-Identifier: Apache-2.0
#include "app/progress.h"
#include "formats/files/error.h"
#include "formats/rays/report.h"
#include "formats/rays/tm25.h"
#include "formats/rays/to_lightfield.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>
#include <thread>

namespace nearfield::app {
namespace {

struct ConvertCommand {
    std::string input, output;
    rays::ReadOptions read;
    rays::ConvertOptions options;
    std::optional<double> flux;
    bool allow_drop = false, reproducible = false;
};

void run(ConvertCommand& command) {
    const double start_s = now_s();
    rays::RaySet set = rays::read_tm25(command.input, command.read);
    if (command.flux)
        rays::scale_to(set, *command.flux);
    for (const std::string& note : set.notes)
        fmt::print(stderr, "{}: {}\n", command.input, note);
    ProgressLine progress("convert");
    command.options.progress = [&](double fraction) { progress.update(fraction); };
    rays::Conversion result = rays::to_lightfield(set, command.options);
    progress.finish();
    fmt::print(stderr, "{}", rays::summary(set, result.report));
    if (!result.report.is_good_enough() && !command.allow_drop) {
        fmt::print(stderr, "{}: not written without --allow-drop\n", command.output);
        throw CLI::RuntimeError(3);
    }
    result.lightfield.provenance =
        rays::describe(set, command.read, command.options, command.flux, result.report);
    result.lightfield.provenance.inputs = {describe_input(command.input)};
    const auto threads = static_cast<int>(std::thread::hardware_concurrency());
    const RunRecord record = finish_run(start_s, threads);
    write_lightfield(result.lightfield, command.reproducible ? std::nullopt : std::optional(record),
                     command.output);
    fmt::print(stderr, "{}: {:.1f} s, peak memory {:.0f} MiB\n", command.output, record.time_s,
               record.peak_memory_mib);
}

}  // namespace

void add_convert(CLI::App& app) {
    auto c = std::make_shared<ConvertCommand>();
    CLI::App* sub = app.add_subcommand("convert", "Makes a light field from a TM-25 ray file");
    sub->add_option("rays", c->input, ".tm25ray (docs/ray_files.md)")->required();
    sub->add_option("-o,--output", c->output, "NAME.lightfield.exr")->required();
    sub->add_option("--u-plane-mm", c->options.u_plane_mm, "of +z, in file's z; default automatic");
    sub->add_option("--s-plane-mm", c->options.s_plane_mm, "of +z, in file's z; default automatic");
    const auto size = [&](const char* name, std::optional<glm::ivec2>& value, const char* help) {
        sub->add_option_function<std::string>(
            name, [&value, name](const std::string& s) { value = rays::parse_size(s, name); },
            help);
    };
    size("--grid", c->options.grid, "WxH basis functions; default automatic");
    size("--texels", c->options.texels, "WxH texels; default automatic");
    sub->add_option("--slabs", c->options.slabs, "1, 5 or 6; automatic by default");
    sub->add_option("--basis", c->options.basis, "bspline, bilinear, box, quadratic")
        ->capture_default_str();
    sub->add_option("--flux-lm,--flux-w", c->flux, "scale the rays to this total flux");
    sub->add_flag("!--no-color", c->options.color, "one channel Y even where rays have color");
    sub->add_flag("--keep-ray-flux", c->read.keep_ray_flux, "do not scale to the header's flux");
    sub->add_flag("--keep-radiometric", c->read.keep_radiometric, "watts, even with spectra");
    sub->add_flag("--allow-drop", c->allow_drop, "write even if over 2 % of the flux is lost");
    sub->add_option("--seed", c->options.seed, "of cross-validation")->capture_default_str();
    sub->add_flag("--reproducible", c->reproducible, "leave date, time and memory out");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
