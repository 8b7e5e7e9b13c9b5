// SPDX-License-Identifier: Apache-2.0
#include "app/progress.h"
#include "app/size_option.h"
#include "formats/files/atomic_file.h"
#include "formats/model/profile.h"
#include "sample_data/simulate.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <map>
#include <memory>
#include <thread>

namespace nearfield::app {
namespace {

struct SimulateCommand {
    std::string lamp, output, receivers, grid = "11x9", texels = "256x128";
    sample_data::SimulateOptions options;
    bool reproducible = false;
};

void run(SimulateCommand command) {
    const double start_s = now_s();
    command.options.grid = parse_size(command.grid, "--grid");
    command.options.texels = parse_size(command.texels, "--texels");
    LightField lightfield;
    if (command.lamp == "reference") {
        lightfield = sample_data::simulate_reference();
    } else {
        ProgressLine progress("simulate");
        lightfield = sample_data::simulate_headlight(command.options, [&](double fraction) {
                         progress.update(fraction);
                     }).lightfield;
        progress.finish();
    }
    if (!command.receivers.empty()) {
        write_file(sample_data::receivers_csv(), command.receivers);
    }
    const RunRecord run =
        finish_run(start_s, static_cast<int>(std::thread::hardware_concurrency()));
    write_lightfield(lightfield, command.reproducible ? std::nullopt : std::optional(run),
                     command.output);
    for (const auto& [name, value] : lightfield.provenance.figures) {
        fmt::print(stderr, "{}: {:.6g}\n", name, value);
    }
}

}  // namespace

void add_simulate(CLI::App& app) {
    auto c = std::make_shared<SimulateCommand>();
    CLI::App* sub =
        app.add_subcommand("simulate", "Makes a synthetic lamp whose radiance is known");
    const auto add = [&](const char* name, auto& value, const char* help) {
        return sub->add_option(name, value, help)->capture_default_str();
    };
    add("lamp", c->lamp, "headlight, or reference (has no options)")
        ->required()
        ->check(CLI::IsMember({"headlight", "reference"}));
    add("-o,--output", c->output, "NAME.lightfield.exr")->required();
    add("--delta-m", c->options.delta_m, "distance of the planes")->check(CLI::Range(0.05, 100.0));
    add("--grid", c->grid, "basis functions over the lens, WxH");
    add("--texels", c->texels, "of every image, WxH");
    add("--basis", c->options.basis, "profile")->check(CLI::IsMember(model::profile_names()));
    const std::map<std::string, Weighting> weightings{{"irradiance", Weighting::Irradiance},
                                                      {"radiance", Weighting::Radiance}};
    sub->add_option("--weighting", c->options.weighting, "irradiance (default) or radiance")
        ->transform(CLI::CheckedTransformer(weightings));
    add("--channels", c->options.channels, "3 (RGB) or 1 (Y)")->check(CLI::IsMember({1, 3}));
    add("--seed", c->options.seed, "of the facets' pattern");
    add("--refine", c->options.refine, "multiplies quadrature nodes")->check(CLI::Range(1, 8));
    add("--receivers", c->receivers, "also write the reference receivers as CSV");
    sub->add_flag("--reproducible", c->reproducible, "leave date, time and memory out");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
