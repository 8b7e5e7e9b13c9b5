// SPDX-License-Identifier: Apache-2.0
#include "app/commands.h"
#include "app/fit_light.h"
#include "app/fit_page.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "fit/solve_capture.h"
#include "formats/files/lightfield_rows.h"
#include "formats/model/profile.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

namespace nearfield::app {
namespace {

struct FitCommand {
    std::string capture, rig, report;
    Output output;
    fit::CaptureFitOptions options;
    std::vector<double> extent_m;
    std::optional<double> flux_lm;
    double flux_limit_rel = 0.05;
    bool luminance_only = false;
};

Provenance provenance_of(const FitCommand& command, const fit::CaptureFit& result) {
    Provenance provenance;
    provenance.program = program_version();
    provenance.command = "fit";
    const Slab& slab = result.lightfield.slabs.front();
    provenance.options = {
        {"basis", command.options.basis},
        {"weighting", slab.weighting == Weighting::Irradiance ? "irradiance" : "radiance"},
        {"texels", fmt::format("{}x{}", slab.texels.x, slab.texels.y)},
        {"extent-m", fmt::format("{},{},{},{}", slab.s_min_m.x, slab.s_min_m.y, slab.s_max_m.x,
                                 slab.s_max_m.y)},
        {"lambda", fmt::format("{:g}", result.lambda)},
        {"model-error-rel", fmt::format("{:g}", result.model_error_rel)},
        {"replicates", fmt::format("{}", command.options.replicates)},
        {"seed", fmt::format("{}", command.options.seed)}};
    provenance.inputs = {describe_input(command.capture + "/capture.json"),
                         describe_input(command.capture + "/log.jsonl"),
                         describe_input(command.rig)};
    provenance.figures = {{"reduced_chi_square", result.report.reduced_chi_square()},
                          {"kkt_worst", result.report.kkt_worst},
                          {"outside_share", result.outside_share},
                          {"saturated_share", result.saturated_share},
                          {"lamp_drift_rel", result.drift_rel},
                          {"resolution_on_s_m", result.resolution_m}};
    return provenance;
}

std::string beside_filter(const fit::CaptureFit& result) {
    if (result.beside_filter.empty())
        return "light beside the filter is not known: plan frames with the filter blocked\n";
    std::string line = "light beside the filter, taken off:";
    for (const fit::BesideFilter& channel : result.beside_filter)
        line += fmt::format(" {:.3g} +- {:.1g} lx", channel.mean_lx, channel.sigma_lx);
    return line + "\n";
}

std::string summary(const fit::CaptureFit& result, const FitLight& light) {
    const Slab& slab = result.lightfield.slabs.front();
    return fmt::format(
        "{} positions, {} x {} texels on {:.3f} x {:.3f} m, resolution {:.2f} mm\n"
        "smoothness {:g}; error of rig and basis {:.2g} %; chi-square {:.2f} by degree of freedom; "
        "KKT residual at most {:.1e}\n"
        "flux {:.5g} lm +- {:.2g} {}, +- {:.2g} % common; {:.2g} % of the light beside "
        "the "
        "extent\n"
        "{}"
        "merge {:.1f} s, smoothness {:.1f} s, solve {:.1f} s\n",
        result.positions, slab.texels.x, slab.texels.y, slab.s_max_m.x - slab.s_min_m.x,
        slab.s_max_m.y - slab.s_min_m.y, 1e3 * result.resolution_m, result.lambda,
        100 * result.model_error_rel, result.report.reduced_chi_square(), result.report.kkt_worst,
        light.flux_lm, light.flux_sigma_lm, result.replicates > 0 ? "of noise and rig" : "of noise",
        100 * result.lightfield.scale_sigma_rel, 100 * result.outside_share, beside_filter(result),
        result.merge_s, result.smoothness_s, result.solve_s);
}

// Whether what was measured otherwise is as near as the user wants it.
bool has_right_flux(const FitCommand& command, double flux_lm) {
    if (!command.flux_lm)
        return true;
    const double off_rel = flux_lm / *command.flux_lm - 1;
    say(fmt::format("flux {:.5g} lm is {:+.2f} % off the {:.5g} lm that were measured otherwise\n",
                    flux_lm, 100 * off_rel, *command.flux_lm));
    if (std::abs(off_rel) <= command.flux_limit_rel)
        return true;
    say(fmt::format("{}: not written: more than --flux-limit-rel {:g}\n", command.output.path,
                    command.flux_limit_rel));
    return false;
}

void write_report(const FitCommand& command,
                  const fit::CaptureFit& result,
                  const FitLight& light,
                  const RunRecord& run) {
    if (command.report.empty())
        return;
    write_page(fit_page(result, light,
                        fmt::format("nearfield fit {} --rig {} -o {}\n{}, {}", command.capture,
                                    command.rig, command.output.path, machine(), cost(run))),
               command.report);
}

// Tiles to where they wait for their file.
fit::FitSink sink_of(LightFieldRows& rows) {
    fit::FitSink sink;
    sink.put = [&rows](const fit::TileResult& tile) {
        rows.put(tile.rows.first_row, tile.rows.row_count, tile.coeffs, tile.sigma);
    };
    sink.put_replicate = [&rows](int replicate, fit::TileRange tile,
                                 const std::vector<float>& coeffs) {
        rows.put_replicate(replicate, tile.first_row, tile.row_count, coeffs);
    };
    return sink;
}

void run_fit(FitCommand& command) {
    const double start_s = now_s();
    check_outputs({command.output.path, command.report}, {command.rig});
    const capture::Capture capture = capture::read_capture(command.capture);
    const rig::Rig rig = rig::read_rig(command.rig);
    const rig::Maps maps = rig::read_maps(command.rig);
    if (!command.extent_m.empty())
        command.options.extent = fit::Extent{{command.extent_m[0], command.extent_m[1]},
                                             {command.extent_m[2], command.extent_m[3]}};
    command.options.wants_color = !command.luminance_only;
    command.options.spool_folder =
        std::filesystem::absolute(command.output.path).parent_path().string();
    ProgressLine line("fit");
    command.options.progress = [&line](double fraction, const std::string& what) {
        line.update(fraction, what);
    };
    const fit::RectifiedCapture rectified =
        fit::rectify_capture({command.capture, capture, rig, maps}, command.options);
    LightFieldRows rows(rectified.planes, {true, command.options.replicates},
                        command.options.spool_folder);
    fit::CaptureFit result =
        fit::solve_capture(rectified, rectified.optics, command.options, sink_of(rows));
    line.finish();
    const FitLight light = light_of(rectified.planes, [&rows](int m) { return rows.image(m); });
    say(summary(result, light));
    result.lightfield.provenance = provenance_of(command, result);
    const RunRecord run = record_run(start_s);
    write_report(command, result, light, run);
    if (!has_right_flux(command, light.flux_lm))
        throw CLI::RuntimeError(3);
    rows.write(result.lightfield, command.output.stored(run), command.output.path);
    say(fmt::format("{}: {}\n", command.output.path, cost(run)));
}

}  // namespace

void add_fit(CLI::App& app) {
    auto c = std::make_shared<FitCommand>();
    CLI::App* sub = add_command(
        app, "fit", "Makes a light field of a capture, with the rig that it was taken with",
        {"nearfield fit headlight_capture --rig rig.json -o headlight.lightfield.exr --report "
         "fit.html"});
    sub->add_option("capture", c->capture, "folder of a capture (docs/capture.md)")
        ->required()
        ->type_name("FOLDER");
    sub->add_option("--rig", c->rig, "what calibrate made of it")
        ->required()
        ->type_name("RIG.json");
    add_output(*sub, c->output, "light field to write, .lightfield.exr");
    sub->add_option("--report", c->report, "page to write: pictures, residuals, sigmas, closure")
        ->type_name("FILE.html");
    add_choice(*sub, "--basis", c->options.basis, same_words(model::profile_names()),
               "basis functions on the stage's grid");
    add_choice<Weighting>(
        *sub, "--weighting", c->options.weighting,
        {{"irradiance", Weighting::Irradiance}, {"radiance", Weighting::Radiance}},
        "what the coefficients multiply (docs/formats.md)");
    add_size(*sub, "--texels", c->options.texels,
             "of every image on S; without it as fine as the camera sees");
    sub->add_option("--extent-m", c->extent_m,
                    "x0,y0,x1,y1 of the rectangle on S; without it what is lit")
        ->delimiter(',')
        ->expected(4)
        ->type_name("M,M,M,M");
    add_number(*sub, "--dark-share", c->options.dark_share, 0.0, 0.5, "SHARE",
               "of the brightest light: what still counts as lit");
    add_number(*sub, "--lambda", c->options.lambda, 0.0, 1e6, "N",
               "smoothness; without it by cross-validation over positions");
    add_number(
        *sub, "--model-error-rel", c->options.model_error_rel, 0.0, 1.0, "SHARE",
        "what rig and basis get wrong, of a texel's brightest position, added to sigma; without "
        "it as large as positions are foretold wrong by the others");
    add_number(
        *sub, "--replicates", c->options.replicates, 0, 1000, "N",
        "fits of other noise and another calibration, kept in the file: 16 give the sigma of "
        "any illuminance to 18 %, for nine times the solver's time");
    add_number(*sub, "--flux-lm", c->flux_lm, 0.0, 1e12, "LM",
               "flux that was measured otherwise (an integrating sphere), to be compared");
    add_number(*sub, "--flux-limit-rel", c->flux_limit_rel, 0.0, 10.0, "SHARE",
               "nothing is written and exit 3 where the flux is further off");
    sub->add_flag("--luminance", c->luminance_only, "one channel, of a color camera too");
    add_seed(*sub, c->options.seed, "of which positions are held out, and of the replicates");
    sub->callback([c] { run_fit(*c); });
}

}  // namespace nearfield::app
