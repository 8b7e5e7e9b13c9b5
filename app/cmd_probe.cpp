// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/probe.h"
#include "formats/files/atomic_file.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

namespace nearfield::app {
namespace {

struct ProbeCommand {
    std::string input, points, output;
    ProbeOptions options;
    bool json = false;
};

void run(const ProbeCommand& command) {
    const double start_s = now_s();
    const LightField lightfield = read_lightfield(command.input);
    const PointList points = read_points(command.points);
    const std::vector<Probed> results = probe(lightfield, points, command.options);
    const std::string text = command.json ? as_json(lightfield.quantity, points, results)
                                          : as_csv(lightfield.quantity, points, results);
    if (command.output.empty())
        fmt::print("{}", text);
    else
        write_file(text, command.output);
    fmt::print(stderr, "{} points, {}; {:.2f} s\n", results.size(),
               command.options.sampler == Sampler::Sum
                   ? std::string("exact sum: no sampling error")
                   : fmt::format("{} samples each", command.options.samples),
               now_s() - start_s);
}

}  // namespace

void add_probe(CLI::App& app) {
    auto c = std::make_shared<ProbeCommand>();
    CLI::App* sub = app.add_subcommand("probe", "Irradiance at points, unshadowed, with its sigma");
    sub->add_option("luminaire", c->input, "luminaire or light field (.exr)")->required();
    sub->add_option("--points", c->points,
                    "CSV with x_m,y_m,z_m,nx,ny,nz in the luminaire's frame (z = 0: first slab's "
                    "S); - reads stdin")
        ->required();
    sub->add_option("-o,--output", c->output, "CSV (or JSON) file; stdout by default");
    sub->add_flag("--json", c->json, "JSON instead of CSV");
    const std::map<std::string, Sampler> samplers{{"sum", Sampler::Sum},
                                                  {"aperture", Sampler::Aperture}};
    sub->add_option("--sampler", c->options.sampler,
                    "sum (default): exact; aperture: Monte Carlo over U, an independent check")
        ->transform(CLI::CheckedTransformer(samplers));
    sub->add_option("--samples", c->options.samples, "of aperture, a point and slab")
        ->check(CLI::Range(2, 1 << 30))
        ->capture_default_str();
    sub->add_option("--seed", c->options.seed, "of aperture")->capture_default_str();
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
