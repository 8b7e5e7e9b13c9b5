// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/probe.h"
#include "app/sampler_options.h"
#include "formats/files/atomic_file.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
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

/// Where the columns of errors come from.
std::string error_of(const ProbeOptions& options) {
    if (options.sampler.method == ProbeMethod::Aperture)
        return fmt::format("{} samples each", options.samples);
    if (options.sampler.method == ProbeMethod::Sampler)
        return fmt::format("{0} sets of {1} samples each: sigma is that of the {0} sets' mean",
                           kProbeSets, std::max(options.samples / kProbeSets, 1U));
    return options.q > 0 ? fmt::format("sum with q = {}: bias bound from q against 2q", options.q)
                         : std::string("exact sum: no sampling error");
}

void check(const ProbeOptions& options) {
    if (options.q > 0 && options.sampler.method != ProbeMethod::Sum)
        throw Error{"cannot probe", "--q", "0 with any sampler but sum",
                    fmt::format("{}", options.q)};
}

void run(const ProbeCommand& command) {
    const double start_s = now_s();
    check_options([&] { check(command.options); });
    check_outputs({command.output}, {command.input, command.points});
    const LightField lightfield = read_lightfield(command.input);
    const PointList points = read_points(command.points);
    const std::vector<Probed> results = probe(lightfield, points, command.options);
    const bool has_bias = command.options.q > 0;
    const std::string text = command.json ? as_json(lightfield.quantity, has_bias, points, results)
                                          : as_csv(lightfield.quantity, has_bias, points, results);
    if (command.output.empty())
        print(text);
    else
        write_file(text, command.output);
    say(fmt::format("{} point{}, {}; {:.2f} s\n", results.size(), results.size() == 1 ? "" : "s",
                    error_of(command.options), now_s() - start_s));
}

std::vector<std::pair<std::string, ProbeSampler>> probe_samplers() {
    std::vector<std::pair<std::string, ProbeSampler>> choices;
    for (const auto& [name, sampler] : sampler_choices())
        choices.push_back({name, sampler ? ProbeSampler{ProbeMethod::Sampler, *sampler}
                                         : ProbeSampler{ProbeMethod::Sum}});
    choices.push_back({"aperture", {ProbeMethod::Aperture}});
    return choices;
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
    add_choice(
        *sub, "--sampler", c->options.sampler, probe_samplers(),
        "sum is exact; aperture is Monte Carlo over U, an independent check (within 0.1 mm of "
        "U it can miss the peak); the others are what render draws");
    add_number(*sub, "--samples", c->options.samples, std::uint32_t{2}, std::uint32_t{1} << 30, "N",
               "of aperture, a point and slab; of samplers, a point, in 16 independent sets");
    add_number(*sub, "--q", c->options.q, 0, 65536, "Q",
               "of sum: windows of at most Q texels, coarser and faster; 0: exact");
    add_number(*sub, "--seed", c->options.seed, std::uint32_t{0},
               std::numeric_limits<std::uint32_t>::max(), "N", "of samples");
    sub->callback([c] { run(*c); });
}

}  // namespace nearfield::app
