// SPDX-License-Identifier: Apache-2.0
#include "app/demo.h"
#include "app/demo_lab.h"
#include "app/options.h"
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

void run_lab(const LabDemoOptions& options) {
    const double start_s = now_s();
    std::optional<ProgressLine> line;
    std::string stage;
    const LabDemoResult result =
        run_lab_demo(options, [&](const std::string& name, double fraction) {
            if (name != stage) {
                line.emplace(name);
                stage = name;
            }
            line->update(fraction);
        });
    line.reset();
    write_lab_report(options, result,
                     fmt::format("nearfield demo --lab --bench {} --plan {} -o {}{}", options.bench,
                                 options.plan, options.folder, options.quick ? " --quick" : ""));
    for (const Stage& done : result.stages)
        fmt::print(stderr, "{}: {:.1f} s; {}\n", done.name, done.time_s, done.error_estimate);
    const Closure& closure = result.closure;
    fmt::print(
        stderr,
        "against the noise-free fit {:.2f} % RMS, against the truth {:.2f} %; flux {:+.2f} %, "
        "delta {:+.3f} %, {:.1f} % within 3 sigma\n",
        100 * closure.irradiance_rms, 100 * closure.irradiance_rms_truth, 100 * closure.flux_rel,
        100 * closure.delta_rel, 100 * closure.coverage_3sigma);
    fmt::print(stderr, "{}/report.html: written after {:.1f} s\n", options.folder,
               now_s() - start_s);
}

struct DemoCommand {
    DemoOptions demo;
    LabDemoOptions lab;
    bool is_lab = false;
};

}  // namespace

void add_demo(CLI::App& app) {
    auto c = std::make_shared<DemoCommand>();
    CLI::App* sub =
        add_command(app, "demo", "Makes a headlight, lights a road with two of it, reports",
                    {"nearfield demo -o out", "nearfield demo --lab -o measured"});
    sub->add_option("-o,--output", c->demo.folder, "folder for scene, lamp, pictures, report")
        ->required()
        ->type_name("FOLDER");
    sub->add_flag("--quick", c->demo.quick, "a smaller lamp and picture: seconds, less exact");
    sub->add_flag(
        "--lab", c->is_lab,
        "measures the headlight first: virtual bench, capture over GigE Vision, calibrate, "
        "fit; and says how far from the truth");
    sub->add_option("--bench", c->lab.bench, "with --lab: the bench")
        ->type_name("BENCH.json")
        ->default_str(c->lab.bench);
    sub->add_option("--plan", c->lab.plan, "with --lab: the plan")
        ->type_name("PLAN.json")
        ->default_str(c->lab.plan);
    sub->add_option("--address", c->lab.address, "with --lab: where the bench's camera listens")
        ->type_name("IPV4")
        ->default_str(c->lab.address);
    sub->callback([c] {
        if (!c->is_lab)
            return run(c->demo);
        c->lab.folder = c->demo.folder;
        c->lab.quick = c->demo.quick;
        run_lab(c->lab);
    });
}

}  // namespace nearfield::app
