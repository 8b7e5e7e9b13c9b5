// SPDX-License-Identifier: Apache-2.0
#include "app/calibration_page.h"
#include "app/commands.h"
#include "app/options.h"
#include "app/output.h"
#include "app/progress.h"
#include "calibrate/calibrate.h"
#include "formats/capture/capture.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <memory>

namespace nearfield::app {
namespace {

struct CalibrateCommand {
    std::string capture, report;
    Output output;
    calibrate::CalibrationOptions options;
    bool bent_board = false, lens_only = false;
};

Provenance provenance_of(const CalibrateCommand& command, const calibrate::Calibration& result) {
    Provenance provenance;
    provenance.program = program_version();
    provenance.command = "calibrate";
    const calibrate::GeometryOptions& geometry = command.options.geometry;
    const auto number = [](double value) { return fmt::format("{:g}", value); };
    provenance.options = {
        {"lens-model", geometry.lens_model == rig::LensModel::Brown5   ? "brown5"
                       : geometry.lens_model == rig::LensModel::Brown8 ? "brown8"
                                                                       : "fisheye"},
        {"bent-board", command.bent_board ? "true" : "false"},
        {"square-pixels", geometry.has_square_pixels ? "true" : "false"},
        {"outlier-sigmas", number(geometry.outlier_sigmas)}};
    if (const auto black_dn = command.options.assumed_black_dn)
        provenance.options.emplace_back("assume-black-dn", number(*black_dn));
    provenance.inputs = {describe_input(command.capture + "/capture.json"),
                         describe_input(command.capture + "/log.jsonl")};
    if (result.geometry) {
        provenance.figures.emplace_back("rms_px", result.geometry->rms_px);
        provenance.figures.emplace_back("corner_sigma_px", result.geometry->corner_sigma_px);
    }
    if (result.rig.radiometry) {
        provenance.figures.emplace_back("scale_sigma_rel", result.rig.radiometry->scale_sigma_rel);
        provenance.figures.emplace_back("scale_systematic_rel",
                                        result.rig.radiometry->scale_systematic_rel);
    }
    return provenance;
}

std::string summary(const calibrate::Calibration& result) {
    std::string text;
    if (result.geometry) {
        const calibrate::Geometry& geometry = *result.geometry;
        text += fmt::format(
            "camera: {} views, RMS {:.3f} px, focal length {:.2f} x {:.2f} px, {} outliers\n",
            geometry.views.size(), geometry.rms_px, geometry.lens.fx_px, geometry.lens.fy_px,
            geometry.outliers.size());
        for (const rig::Parameter& parameter : geometry.parameters)
            if (parameter.name == "delta_m" && geometry.planes)
                text += fmt::format("planes: {:.3f} +- {:.3f} mm apart, pitch {:.4f} x {:.4f} mm\n",
                                    1e3 * parameter.value, 1e3 * parameter.sigma,
                                    1e3 * geometry.planes->planes.pitch_m.x,
                                    1e3 * geometry.planes->planes.pitch_m.y);
    }
    if (result.radiometry) {
        const rig::Radiometry& radiometry = *result.rig.radiometry;
        text +=
            fmt::format("sensor: {:.3f} e-/DN, read noise {:.2f} DN; light is {}\n",
                        radiometry.gain_e_per_dn, radiometry.read_noise_dn,
                        radiometry.is_absolute
                            ? fmt::format("absolute, +- {:.2f} % random, +- {:.2g} % systematic",
                                          100 * radiometry.scale_sigma_rel,
                                          100 * radiometry.scale_systematic_rel)
                            : std::string("relative"));
    }
    for (const calibrate::Flag& flag : result.flags)
        text += fmt::format("note: {}: {}\n", flag.what, flag.advice);
    return text;
}

void run_calibrate(CalibrateCommand& command) {
    const double start_s = now_s();
    check_outputs({command.output.path, command.report}, {});
    const capture::Capture capture = capture::read_capture(command.capture);
    command.options.geometry.is_board_flat = !command.bent_board;
    command.options.geometry.with_planes = !command.lens_only;
    ProgressLine line("calibrate");
    command.options.progress = [&line](const std::string& step, double fraction) {
        line.update(fraction, step);
    };
    calibrate::Calibration result =
        calibrate::calibrate_capture(command.capture, capture, command.options);
    line.finish();
    result.rig.provenance = provenance_of(command, result);
    say(summary(result));
    const RunRecord run = record_run(start_s);
    write_rig(result.rig, result.maps, command.output.stored(run), command.output.path);
    if (!command.report.empty())
        write_page(calibration_page(
                       result, fmt::format("nearfield calibrate {} -o {}\n{}, {}", command.capture,
                                           command.output.path, machine(), cost(run))),
                   command.report);
    say(fmt::format("{}: {}\n", command.output.path, cost(run)));
}

}  // namespace

void add_calibrate(CLI::App& app) {
    auto c = std::make_shared<CalibrateCommand>();
    CLI::App* sub = add_command(
        app, "calibrate", "Finds out what a bench is, from a capture: camera, planes, light",
        {"nearfield calibrate headlight_capture -o rig.json --report calibration.html",
         "nearfield calibrate board_photographs -o lens.json --lens-model fisheye"});
    sub->add_option("capture", c->capture, "folder of a capture (docs/capture.md)")
        ->required()
        ->type_name("FOLDER");
    add_output(*sub, c->output, "rig to write, .json; its maps stand beside it, .maps.exr");
    sub->add_option("--report", c->report, "page to write: residuals, maps, curves, sigmas")
        ->type_name("FILE.html");
    calibrate::GeometryOptions& geometry = c->options.geometry;
    add_choice<rig::LensModel>(*sub, "--lens-model", geometry.lens_model,
                               {{"brown5", rig::LensModel::Brown5},
                                {"brown8", rig::LensModel::Brown8},
                                {"fisheye", rig::LensModel::Fisheye}},
                               "how the lens distorts");
    sub->add_flag("--bent-board", c->bent_board, "estimate the board's bend too, and use it");
    sub->add_flag("--square-pixels", geometry.has_square_pixels, "one focal length for both axes");
    sub->add_flag("--lens-only", c->lens_only, "the camera alone, not the planes S and U");
    add_number(*sub, "--outlier-sigmas", geometry.outlier_sigmas, 2.0, 1000.0, "N",
               "corners further off are named and left out");
    add_number(*sub, "--assume-black-dn", c->options.assumed_black_dn, 0.0, 65535.0, "DN",
               "without darks: this black level and no dark current");
    sub->callback([c] { run_calibrate(*c); });
}

}  // namespace nearfield::app
