// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/probe.h"
#include "formats/files/atomic_file.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdint>
#include <limits>
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
    check_outputs({command.output}, {command.input, command.points});
    const LightField lightfield = read_lightfield(command.input);
    const PointList points = read_points(command.points);
    const std::vector<Probed> results = probe(lightfield, points, command.options);
    const std::string text = command.json ? as_json(lightfield.quantity, points, results)
                                          : as_csv(lightfield.quantity, points, results);
    if (command.output.empty())
        print(text);
    else
        write_file(text, command.output);
    say(fmt::format("{} point{}, {}; {:.2f} s\n", results.size(), results.size() == 1 ? "" : "s",
                    command.options.sampler == Sampler::Sum
                        ? std::string("exact sum: no sampling error")
                        : fmt::format("{} samples each", command.options.samples),
                    now_s() - start_s));
}

}  // namespace

void add_probe(CLI::App& app) {
    auto c = std::make_shared<ProbeCommand>();
    CLI::App* sub = add_command(
        app, "probe", "Irradiance at points, unshadowed, with its sigma",
        {"nearfield probe headlight.luminaire.exr --points points.csv",
         "nearfield probe headlight.luminaire.exr --points points.csv --json -o lux.json",
         "printf 'x_m,y_m,z_m,nx,ny,nz\\n0,0,10,0,0,-1\\n' |",
         "    nearfield probe headlight.luminaire.exr --points -"});
    sub->add_option("luminaire", c->input, "luminaire or light field, .exr")
        ->required()
        ->type_name("FILE");
    sub->add_option("--points", c->points,
                    "CSV with columns x_m,y_m,z_m,nx,ny,nz in the luminaire's frame (z = 0: the "
                    "first slab's S); - reads stdin")
        ->required()
        ->type_name("FILE");
    sub->add_option("-o,--output", c->output, "file to write; by default stdout")
        ->type_name("FILE");
    sub->add_flag("--json", c->json, "JSON instead of CSV");
    add_choice(*sub, "--sampler", c->options.sampler,
               {{"sum", Sampler::Sum}, {"aperture", Sampler::Aperture}},
               "sum is exact; aperture is Monte Carlo over U, an independent check");
    add_number(*sub, "--samples", c->options.samples, std::uint32_t{2}, std::uint32_t{1} << 30, "N",
               "of aperture, a point and slab");
    add_number(*sub, "--seed", c->options.seed, std::uint32_t{0},
               std::numeric_limits<std::uint32_t>::max(), "N", "of aperture");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
