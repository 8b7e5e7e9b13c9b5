// SPDX-License-Identifier: Apache-2.0
#include "app/demo.h"
#include "app/progress.h"
#include "formats/files/provenance.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>
#include <optional>

namespace nearfield::app {
namespace {

void run(const DemoOptions& options) {
    const double start_s = now_s();
    std::optional<ProgressLine> line;
    std::string stage;
    const DemoResult result = run_demo(options, [&](const std::string& name, double fraction) {
        if (name != stage) {
            line.emplace(name);
            stage = name;
        }
        line->update(fraction);
    });
    line.reset();
    const std::string command_line =
        "nearfield demo -o " + options.folder + (options.quick ? " --quick" : "");
    write_demo_report(options, result, command_line);
    for (const Stage& done : result.stages) {
        fmt::print(stderr, "{}: {:.1f} s; {}\n", done.name, done.time_s, done.error_estimate);
    }
    fmt::print(stderr, "{}/report.html: written after {:.1f} s\n", options.folder,
               now_s() - start_s);
}

}  // namespace

void add_demo(CLI::App& app) {
    auto options = std::make_shared<DemoOptions>();
    CLI::App* sub =
        app.add_subcommand("demo", "Makes a headlight, lights a road with two of it, reports");
    sub->add_option("-o,--output", options->folder, "folder for scene, lamp, pictures, report")
        ->required();
    sub->add_flag("--quick", options->quick, "a smaller lamp and picture: seconds, less exact");
    sub->callback([options] { run(*options); });
}

}  // namespace nearfield::app
