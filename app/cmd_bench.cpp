// SPDX-License-Identifier: Apache-2.0
#include "app/bench/calibration.h"
#include "app/bench/environment.h"
#include "app/bench/files.h"
#include "app/bench/fit.h"
#include "app/bench/papers.h"
#include "app/bench/shadows.h"
#include "app/bench/summary.h"
#include "app/bench/sweeps.h"
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "formats/files/atomic_file.h"
#include "formats/files/points.h"
#include "sample_data/reference_lamp.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>

namespace nearfield::app {
namespace {

enum class What { Accuracy, Shadows, Papers, Calibration, Fit, Environment };

constexpr const char *kOfAccuracy = "bench accuracy", *kOfShadows = "bench shadows",
                     *kOfPapers = "bench papers", *kOfCalibration = "bench calibration",
                     *kOfFit = "bench fit", *kOfEnvironment = "bench environment";

struct BenchCommand {
    What what = What::Accuracy;
    std::string input, points, page, csv;
    bool json = false;
    bench::SweepOptions options;
    bench::ShadowSweepOptions shadows;
    bench::PapersOptions papers;
    bench::CalibrationSweepOptions calibration;
    bool quick = false;
    std::string mesh;
    std::vector<std::string> studies;
};

LightField read_lamp(const BenchCommand& command) {
    return command.input.empty() ? sample_data::make_reference_lamp()
                                 : read_lightfield(command.input);
}

std::vector<model::Receiver> read_receivers(const BenchCommand& command) {
    if (command.points.empty())
        return sample_data::reference_receivers();
    const PointList points = read_points(command.points);
    std::vector<model::Receiver> receivers;
    for (std::size_t k = 0; k < points.positions_m.size(); ++k)
        receivers.push_back({points.positions_m[k], points.normals[k]});
    return receivers;
}

bench::Setup setup_of(const BenchCommand& command,
                      const LightField& lamp,
                      std::size_t receivers,
                      const std::string& command_line) {
    const Slab& slab = lamp.slabs.front();
    return {
        fmt::format(
            "{}, {}{} x {} images of {} x {} texels, {} channel{}, {} basis",
            command.input.empty() ? "the reference lamp" : command.input,
            lamp.slabs.size() == 1 ? "" : fmt::format("{} slabs, the first ", lamp.slabs.size()),
            slab.grid.x, slab.grid.y, slab.texels.x, slab.texels.y, slab.channels,
            slab.channels == 1 ? "" : "s", slab.profile.name),
        command.points.empty() ? fmt::format("{}, scattered up to 6.5 m ahead of it", receivers)
                               : fmt::format("the {} of {}", receivers, command.points),
        command_line, machine()};
}

void run_accuracy(const BenchCommand& command, const std::string& command_line) {
    check_outputs({command.page, command.csv}, {command.input, command.points});
    const LightField lamp = read_lamp(command);
    const std::vector<model::Receiver> receivers = read_receivers(command);
    const bench::Setup setup = setup_of(command, lamp, receivers.size(), command_line);
    ProgressLine progress("bench accuracy");
    const bench::Findings findings =
        bench::run_sweeps(lamp.slabs, receivers, command.options,
                          [&](double fraction) { progress.update(fraction); });
    progress.finish();

    if (!command.csv.empty())
        write_file(bench::as_csv(findings), command.csv);
    bench::write_page(findings, setup, command.page);
    if (command.json)
        print(bench::as_json(findings, setup));
    for (const std::string& sentence : bench::sentences(bench::summarize(findings)))
        say(sentence + "\n");
    if (findings.skipped > 0)
        say(fmt::format("settings left out by --time-limit-s: {}\n", findings.skipped));
    say(fmt::format("{}: {} settings measured in {:.0f} s on {} threads\n", command.page,
                    findings.results.size(), findings.time_s, findings.threads));
}

void run_shadows(const BenchCommand& command, const std::string& command_line) {
    if (command.input.empty())
        throw CLI::RequiredError("a scene");
    check_outputs({command.page}, {command.input});
    const Scene scene = read_scene(command.input);
    ProgressLine progress(kOfShadows);
    const bench::ShadowFindings findings = bench::run_shadow_sweeps(
        scene, command.shadows, [&](double fraction) { progress.update(fraction); });
    progress.finish();
    const bench::ShadowSetup setup{command.input, command_line, machine()};
    bench::write_page(findings, setup, command.page);
    if (command.json)
        print(bench::as_json(findings, setup));
    say(fmt::format("{}: {} settings measured in {:.0f} s on {}\n", command.page,
                    findings.results.size(), findings.time_s, findings.device));
}

void run_papers(const BenchCommand& command, const std::string& command_line) {
    if (!command.input.empty() || command.json)
        throw CLI::ValidationError(
            kOfPapers, "expected neither a file nor --json: it makes its lamps, and writes a CSV");
    bench::PapersOptions options = command.papers;
    options.folder = command.page;
    options.quick = command.quick;
    ProgressLine progress(kOfPapers);
    const bench::PapersFindings findings = bench::run_papers(
        options,
        [&](const std::string& what, double fraction) { progress.update(fraction, what); });
    progress.finish();
    const auto path = [&](const char* name) {
        return (std::filesystem::path(options.folder) / name).string();
    };
    write_file(bench::as_csv(findings), path("papers.csv"));
    bench::write_page(findings, {command_line, machine(), options.quick}, path("papers.html"));
    say(fmt::format("{}: {} settings measured in {:.0f} s\n", path("papers.html"),
                    findings.rows.size(), findings.time_s));
}

void run_calibration(const BenchCommand& command, const std::string& command_line) {
    if (!command.input.empty() || command.json)
        throw CLI::ValidationError(
            kOfCalibration,
            "expected neither a file nor --json: it makes its bench, and writes a CSV");
    bench::CalibrationSweepOptions options = command.calibration;
    options.quick = command.quick;
    options.seed = command.options.seed;
    const std::filesystem::path folder(command.page);
    bench::make_folder(folder.string());
    ProgressLine progress(kOfCalibration);
    const bench::CalibrationFindings findings =
        bench::run_calibration_sweeps(options, [&](double fraction) { progress.update(fraction); });
    progress.finish();
    write_file(bench::as_csv(findings), (folder / "calibration.csv").string());
    const std::string page = (folder / "calibration.html").string();
    bench::write_page(findings, {command_line, machine(), options.quick}, page);
    say(fmt::format("{}: {} settings, {} calibrations each, in {:.0f} s\n", page,
                    findings.settings.size(), findings.trials, findings.time_s));
}

void run_fit(const BenchCommand& command, const std::string& command_line) {
    if (!command.input.empty())
        throw CLI::ValidationError(kOfFit, "expected no file: it makes its lamp");
    const std::filesystem::path folder(command.page);
    bench::make_folder(folder.string());
    ProgressLine progress(kOfFit);
    const bench::FitFindings findings = bench::run_fit_sweeps(
        {command.quick, command.options.seed}, [&](double fraction) { progress.update(fraction); });
    progress.finish();
    const bench::FitSetup setup{command_line, machine(), command.quick};
    write_file(bench::as_csv(findings), (folder / "fit.csv").string());
    const std::string page = (folder / "fit.html").string();
    bench::write_page(findings, setup, page);
    if (command.json)
        print(bench::as_json(findings, setup));
    for (const bench::SolverTime& solver : findings.solvers.solvers)
        say(fmt::format("{}: {} a texel, {:.3g} times the first\n", solver.name,
                        bench::time_text(solver.texel_us), solver.times_ours));
    say(fmt::format("{}: {} settings measured in {:.0f} s\n", page, findings.results.size(),
                    findings.time_s));
}

void run_environment(const BenchCommand& command, const std::string& command_line) {
    const std::filesystem::path folder(command.page);
    bench::make_folder(folder.string());
    ProgressLine progress(kOfEnvironment);
    const bench::EnvironmentFindings findings = bench::run_environment_sweeps(
        {folder.string(), command.input, command.mesh, command.quick, command.studies},
        [&](double fraction) { progress.update(fraction); });
    progress.finish();
    const bench::EnvironmentSetup setup{command_line, machine(), command.quick};
    write_file(bench::as_csv(findings), (folder / "environment.csv").string());
    const std::string page = (folder / "environment.html").string();
    bench::write_page(findings, setup, page);
    if (command.json)
        print(bench::as_json(findings, setup));
    for (const std::string& sentence : bench::conclusions(findings))
        say(sentence + "\n");
    say(fmt::format("{}: {} settings measured in {:.0f} s\n", page, findings.rows.size(),
                    findings.time_s));
}

// What only others of them take.
void refuse_foreign_options(const CLI::App& command, const std::string& own) {
    for (const CLI::Option* option : command.get_options())
        if (option->count() > 0 && option->get_group().starts_with("bench ") &&
            option->get_group().find(own) == std::string::npos)
            throw CLI::ValidationError(
                option->get_name(), fmt::format("expected no option of {}", option->get_group()));
}

// The call as it can be repeated: options that were given, in the order of the help.
std::string command_line(const CLI::App& command) {
    std::string text = "nearfield " + command.get_name();
    for (const CLI::Option* option : command.get_options()) {
        if (option->count() == 0)
            continue;
        text += option->get_positional() ? "" : " " + option->get_name();
        if (option->get_items_expected_max() > 0)
            text += " " + option->as<std::string>();
    }
    return text;
}

// "4,16,63": numbers 1 ... most, sorted.
void add_sizes(CLI::App& command,
               const std::string& name,
               std::vector<int>& values,
               int most,
               const std::string& help) {
    const auto parse = [most](const std::string& text) {
        std::vector<int> sizes;
        for (const std::string& word : CLI::detail::split(text, ',')) {
            int size = 0;
            if (!CLI::detail::lexical_cast(word, size) || size < 1 || size > most)
                return std::vector<int>{};
            sizes.push_back(size);
        }
        std::sort(sizes.begin(), sizes.end());
        sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
        return sizes;
    };
    CLI::Option* option = command.add_option_function<std::string>(
        name, [&values, parse](const std::string& text) { values = parse(text); }, help);
    option->default_str(fmt::format("{}", fmt::join(values, ",")))->type_name("N,N,...");
    add_checks(option, fmt::format("numbers 1 ... {}, separated by commas", most),
               [parse](const std::string& text) { return !parse(text).empty(); });
}

// Some of a few words, separated by commas; all by default.
void add_words(CLI::App& command,
               const std::string& name,
               std::vector<std::string>& values,
               const std::vector<std::string>& known,
               const std::string& help) {
    CLI::Option* option = command.add_option_function<std::string>(
        name, [&values](const std::string& text) { values = CLI::detail::split(text, ','); },
        fmt::format("{}: {}; all by default", help, fmt::join(known, ",")));
    add_checks(option->type_name("NAME,..."), fmt::format("{}", fmt::join(known, ", ")),
               [known](const std::string& text) {
                   const std::vector<std::string> words = CLI::detail::split(text, ',');
                   return std::all_of(words.begin(), words.end(), [&](const std::string& word) {
                       return std::find(known.begin(), known.end(), word) != known.end();
                   });
               });
}

void add_sweep_options(CLI::App& sub, bench::SweepOptions& options) {
    constexpr int kMostK = 1 << 24, kMostQ = 1 << 16;
    add_words(sub, "--samplers", options.samplers, bench::sampler_names(), "samplers to measure");
    add_words(sub, "--sweeps", options.sweeps, bench::sweep_names(), "what to vary");
    add_sizes(sub, "--k", options.k, kMostK, "samples a receiver");
    add_sizes(sub, "--q", options.q, kMostQ, "widest window in texels, of sum; exact comes always");
    add_number(sub, "--repeats", options.repeats, 1, 1000, "N",
               "runs with other random numbers, over which errors are pooled");
    add_number(sub, "--time-limit-s", options.time_limit_s, 1.0, 1e6, "S",
               "settings that would take longer are left out");
    add_number(sub, "--threads", options.threads, 0, 4096, "N",
               "0: all cores; errors are the same");
}

void add_shadow_options(CLI::App& sub, bench::ShadowSweepOptions& options) {
    sub.add_option("--camera", options.camera, "camera by name; the first by default")
        ->type_name("NAME");
    add_number(sub, "--width", options.size_px.x, 1, 16384, "PX", "pixels");
    add_number(sub, "--rays", options.samples, 2, 1 << 20, "N",
               "rays of a pixel and lamp in the traced picture");
    add_number(sub, "--runs", options.repeats, 1, 1000, "N",
               "of each setting; its least times count");
    add_sizes(sub, "--maps", options.maps, 2048, "maps a lamp; one a cell comes always");
    add_sizes(sub, "--map-px", options.map_px, 16384, "sizes of a map, pixels a side");
}

struct Bench {
    const char* name;
    void (*run)(const BenchCommand&, const std::string& command_line);
};

Bench of_what(What what) {
    switch (what) {
        case What::Shadows:
            return {kOfShadows, run_shadows};
        case What::Papers:
            return {kOfPapers, run_papers};
        case What::Calibration:
            return {kOfCalibration, run_calibration};
        case What::Fit:
            return {kOfFit, run_fit};
        case What::Environment:
            return {kOfEnvironment, run_environment};
        case What::Accuracy:
            break;
    }
    return {kOfAccuracy, run_accuracy};
}

}  // namespace

void add_bench(CLI::App& app) {
    auto c = std::make_shared<BenchCommand>();
    CLI::App* sub = add_command(
        app, "bench",
        "Measures what accuracy costs: samplers and their knobs, shadow maps, calibration, fit, "
        "environments",
        {"nearfield bench accuracy -o accuracy.html --csv accuracy.csv",
         "nearfield bench accuracy headlight.luminaire.exr --receivers points.csv -o accuracy.html",
         "nearfield bench accuracy --samplers sum,pdis --k 16,63,1000 -o pdis.html",
         "nearfield bench shadows scene.gltf -o shadows.html", "nearfield bench papers -o papers",
         "nearfield bench calibration -o calibration", "nearfield bench fit -o fit",
         "nearfield bench environment hall.hdr -o environment"});
    add_choice(
        *sub, "what", c->what,
        {{"accuracy", What::Accuracy},
         {"shadows", What::Shadows},
         {"papers", What::Papers},
         {"calibration", What::Calibration},
         {"fit", What::Fit},
         {"environment", What::Environment}},
        "accuracy: of samplers and sums, on a lamp; shadows: of shadow maps, on a scene; "
        "papers: a published paper's figures again, on lamps of its sizes; calibration: errors "
        "of a calibrated bench against noise, boards, bends, tilts, lens models; fit: errors of a "
        "measured light field against positions, exposures, filter, basis, planes, smoothness, "
        "and the solver beside general ones; environment: filtered light and shadows of what is "
        "around, "
        "beside a paper's text")
        ->required();
    sub->add_option(
           "input", c->input,
           "accuracy: luminaire or light field, .exr, by default the reference lamp (nearfield "
           "simulate reference); shadows: scene, .gltf or .glb; "
           "environment: latitude-longitude picture, .hdr or .exr, by default a hall by formula")
        ->type_name("FILE");
    sub->add_option("-o,--output", c->page,
                    "page to write, .html; papers, calibration, fit, environment: folder")
        ->required()
        ->type_name("FILE");
    sub->add_flag("--json", c->json, "all measurements as JSON on stdout");
    sub->option_defaults()->group(kOfAccuracy);
    CLI::Option* points = sub->add_option(
        "--receivers", c->points,
        "CSV with columns x_m,y_m,z_m,nx,ny,nz in the luminaire's frame; by default those "
        "of the reference lamp");
    points->type_name("FILE");
    sub->add_option("--csv", c->csv, "all measurements as a table")->type_name("FILE");
    add_sweep_options(*sub, c->options);
    sub->option_defaults()->group(kOfShadows);
    add_shadow_options(*sub, c->shadows);
    sub->option_defaults()->group(fmt::format("{}, {}, {}", kOfAccuracy, kOfCalibration, kOfFit));
    add_number(*sub, "--seed", c->options.seed, std::uint32_t{0},
               std::numeric_limits<std::uint32_t>::max(), "N", "of all random numbers");
    sub->option_defaults()->group(
        fmt::format("{}, {}, {}, {}", kOfPapers, kOfCalibration, kOfFit, kOfEnvironment));
    sub->add_flag("--quick", c->quick,
                  "small lamps and frames, few calibrations and texels: seconds, no conclusions");
    sub->option_defaults()->group(kOfCalibration);
    add_number(*sub, "--trials", c->calibration.trials, 2, 100000, "N",
               "calibrations of each setting, 20 and of quick runs 3 by default")
        ->default_str("");
    sub->option_defaults()->group(kOfEnvironment);
    sub->add_option("--mesh", c->mesh,
                    "scene whose first mesh is the uneven surface; by default a knobby ball")
        ->type_name("FILE");
    add_words(*sub, "--studies", c->studies, bench::environment_studies(), "what to measure");
    sub->option_defaults()->group(kOfPapers);
    add_number(*sub, "--frame-px", c->papers.frame_px, 16, 4096, "PX",
               "width of the samplers' frames, 240 and of quick runs 32 by default; others follow")
        ->default_str("");
    sub->callback([c, sub] {
        const auto [own, run] = of_what(c->what);
        refuse_foreign_options(*sub, own);
        run(*c, command_line(*sub));
    });
}

}  // namespace nearfield::app
