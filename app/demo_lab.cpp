// SPDX-License-Identifier: Apache-2.0
#include "app/demo_lab.h"

#include "app/calibration_page.h"
#include "app/capture_run.h"
#include "app/fit_page.h"
#include "app/lab_camera.h"
#include "app/output.h"
#include "fit/solve_capture.h"
#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/read_file.h"
#include "formats/model/luminaire.h"
#include "formats/model/tables.h"
#include "render/device.h"
#include "render/display.h"
#include "sample_data/demo_scene.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace nearfield::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLuminaireName = "lamp.luminaire.exr";

std::string in_folder(const LabDemoOptions& options, const std::string& name) {
    return (fs::path(options.folder) / name).string();
}

// One stage: its time, and its own words on its error.
template <typename Work>
void take_stage(LabDemoResult& result, const std::string& name, const Work& work) {
    const double start_s = now_s();
    Stage stage;
    stage.name = name;
    stage.error_estimate = work();
    const RunRecord record = record_run(start_s);
    stage.time_s = record.time_s;
    stage.peak_memory_mib = record.peak_memory_mib;
    result.stages.push_back(std::move(stage));
}

// The plan, with the address at which the bench is served.
std::string write_plan(const LabDemoOptions& options) {
    Json plan = parse_json(read_file(options.plan), options.plan);
    plan["camera"]["device"] = options.address;
    std::string path = in_folder(options, "plan.json");
    write_file(plan.dump(2) + "\n", path);
    return path;
}

void capture_bench(const LabDemoOptions& options,
                   const DemoProgress& progress,
                   LabDemoResult& result) {
    sample_data::Prepared prepared;
    take_stage(result, "prepare the bench", [&] {
        prepared =
            sample_data::prepare(sample_data::read_bench(options.bench),
                                 [&](double fraction) { progress("prepare the bench", fraction); });
        return std::string("stated in its truth file");
    });
    take_stage(result, "capture over GigE Vision", [&] {
        gige::CameraOptions camera_options;
        camera_options.address = options.address;
        camera_options.fast = true;
        const gige::Camera camera(camera_options, lab_of(prepared));
        CaptureOptions capture_options;
        capture_options.plan = write_plan(options);
        capture_options.folder = in_folder(options, "capture");
        const acquire::SessionResult session = run_capture(capture_options);
        camera.check();
        return fmt::format("{} frames; exposure ratios off by at most {:.2f} %", session.frames,
                           100 * session.worst_ratio_rel);
    });
}

void calibrate_stage(const LabDemoOptions& options,
                     const capture::Capture& capture,
                     const DemoProgress& progress,
                     LabDemoResult& result) {
    take_stage(result, "calibrate", [&] {
        calibrate::CalibrationOptions calibration_options;
        calibration_options.progress = [&](const std::string&, double fraction) {
            progress("calibrate", fraction);
        };
        result.calibration = calibrate::calibrate_capture(in_folder(options, "capture"), capture,
                                                          calibration_options);
        result.calibration.rig.provenance.program = program_version();
        result.calibration.rig.provenance.command = "demo --lab";
        write_rig(result.calibration.rig, result.calibration.maps, std::nullopt,
                  in_folder(options, "rig.json"));
        return fmt::format("corners {:.3f} px RMS; scale {:.2f} % random, {:.2g} % systematic",
                           result.calibration.geometry->rms_px,
                           100 * result.calibration.rig.radiometry->scale_sigma_rel,
                           100 * result.calibration.rig.radiometry->scale_systematic_rel);
    });
}

fit::CaptureFitOptions fit_options_of(const LabDemoOptions& options, const DemoProgress& progress) {
    fit::CaptureFitOptions fit_options;
    if (options.quick)
        fit_options.texels = glm::ivec2(128, 80);
    fit_options.replicates = options.quick ? 4 : 16;
    fit_options.spool_folder = options.folder;
    fit_options.progress = [&progress](double fraction, const std::string&) {
        progress("fit", fraction);
    };
    return fit_options;
}

void fit_stage(const LabDemoOptions& options,
               const fit::CaptureFitOptions& fit_options,
               const capture::Capture& capture,
               std::optional<fit::RectifiedCapture>& rectified,
               LabDemoResult& result) {
    take_stage(result, "fit", [&] {
        rectified.emplace(fit::rectify_capture({in_folder(options, "capture"), capture,
                                                result.calibration.rig, result.calibration.maps},
                                               fit_options));
        result.fit = fit::solve_capture(*rectified, rectified->optics, fit_options);
        result.fit.lightfield.provenance.program = program_version();
        result.fit.lightfield.provenance.command = "demo --lab";
        write_lightfield(result.fit.lightfield, std::nullopt,
                         in_folder(options, "lamp.lightfield.exr"));
        return fmt::format("chi-square {:.2f} by degree of freedom, KKT {:.1e}",
                           result.fit.report.reduced_chi_square(), result.fit.report.kkt_worst);
    });
}

void pack_and_render(const LabDemoOptions& options,
                     const DemoProgress& progress,
                     LabDemoResult& result) {
    take_stage(result, "pack", [&] {
        progress("pack", 0.0);
        LightField rendered = result.fit.lightfield;
        rendered.slabs.front().replicates.clear();
        write_luminaire(model::pack(rendered, false), std::nullopt,
                        in_folder(options, kLuminaireName));
        return std::string("exact; tables in float from sums in double; no replicates");
    });
    take_stage(result, "render", [&] {
        const Scene scene =
            sample_data::make_demo_scene(kLuminaireName, in_folder(options, kLuminaireName),
                                         result.fit.lightfield.slabs.front().delta_m);
        write_scene(scene, in_folder(options, "scene.gltf"), BufferPlace::SideFile);
        render::RenderOptions render_options;
        render_options.size_px = options.quick ? glm::ivec2(320, 180) : glm::ivec2(960, 540);
        render_options.camera = scene.cameras.front().name;
        render_options.samples = 16;
        render::RenderHooks hooks;
        hooks.progress = [&](const render::RenderProgress& at) { progress("render", at.fraction); };
        render::Rendered rendered = render::render(scene, render_options, hooks);
        const render::Display display = render::display(rendered.picture, {});
        result.picture_png = "picture.png";
        write_png(display.srgb, rendered.picture.size_px, in_folder(options, result.picture_png));
        return render::summary(rendered.report.sampling);
    });
}

// The bench's clock at the first look at the reference, else at the first light.
double reference_time_s(const capture::Capture& capture) {
    for (const capture::ShotKind kind : {capture::ShotKind::Reference, capture::ShotKind::Light})
        for (const auto& [number, frame] : capture.frames)
            if (frame.shot.kind == kind)
                return 1e-9 * static_cast<double>(frame.camera_time_ns);
    return 0;
}

report::Section closure_section(const Closure& closure) {
    report::Section section{"How far from the truth", {}, {}, {}, {}};
    section.paragraphs.emplace_back(
        "The virtual bench knows its lamp by formula. No stage read it; this comparison does. The "
        "noise-free fit has the same basis, grid and smoothness, "
        "on the bench as it really is: what it misses is the basis', what the measured one misses "
        "beside it is the measurement's.");
    report::Table table{"", {"what", "value"}, {}};
    const auto percent = [](double share) { return fmt::format("{:.3g} %", 100 * share); };
    table.rows = {
        {"illuminance at receivers 1 ... 25 m away, RMS against the noise-free fit",
         percent(closure.irradiance_rms)},
        {"the same against the formula", percent(closure.irradiance_rms_truth)},
        {"receivers within three sigma of the noise-free fit", percent(closure.coverage_3sigma)},
        {"total flux against the formula", percent(closure.flux_rel)},
        {"the noise-free fit's illuminance against the formula, RMS",
         percent(closure.basis_rms_truth)},
        {"the noise-free fit's flux against the formula", percent(closure.noise_free_flux_rel)},
        {"cut-off line 25 m away against the formula's, at most",
         fmt::format("{:.3f} degrees", closure.cutoff_deg)},
        {"the noise-free fit's", fmt::format("{:.3f} degrees", closure.cutoff_basis_deg)},
        {"where log E falls fastest, which blur moves upwards",
         fmt::format("{:.3f} degrees", closure.cutoff_gradient_deg)},
        {"distance of the planes", percent(closure.delta_rel)},
        {"the lamp's light when it was measured, over its nominal",
         fmt::format("{:.4f}", closure.lamp_factor)}};
    section.tables.push_back(std::move(table));
    report::Table budget{
        "Error budget: each source by itself, all else as it really was, against "
        "the noise-free fit",
        {"source", "illuminance, RMS", "mean", "flux"},
        {}};
    for (const ErrorSource& source : closure.budget)
        budget.rows.push_back({source.what, percent(source.irradiance_rms),
                               percent(source.irradiance_bias), percent(source.flux_rel)});
    section.tables.push_back(std::move(budget));
    return section;
}

Json budget_json(const Closure& closure) {
    Json budget = Json::array();
    for (const ErrorSource& source : closure.budget)
        budget.push_back({{"source", source.what},
                          {"irradiance_rms", source.irradiance_rms},
                          {"irradiance_bias", source.irradiance_bias},
                          {"flux_rel", source.flux_rel}});
    return budget;
}

Json closure_json(const Closure& closure) {
    return {{"irradiance_rms", closure.irradiance_rms},
            {"irradiance_rms_truth", closure.irradiance_rms_truth},
            {"flux_rel", closure.flux_rel},
            {"delta_rel", closure.delta_rel},
            {"coverage_3sigma", closure.coverage_3sigma},
            {"noise_free_flux_rel", closure.noise_free_flux_rel},
            {"basis_rms_truth", closure.basis_rms_truth},
            {"cutoff_deg", closure.cutoff_deg},
            {"cutoff_basis_deg", closure.cutoff_basis_deg},
            {"cutoff_gradient_deg", closure.cutoff_gradient_deg},
            {"receivers", closure.receivers.size()},
            {"lamp_factor", closure.lamp_factor}};
}

}  // namespace

LabDemoResult run_lab_demo(const LabDemoOptions& options, const DemoProgress& progress) {
    std::error_code failure;
    fs::create_directories(options.folder, failure);
    if (failure)
        throw Error("cannot make folder", options.folder, {}, failure.message());
    LabDemoResult result;
    capture_bench(options, progress, result);
    const capture::Capture capture = capture::read_capture(in_folder(options, "capture"));
    calibrate_stage(options, capture, progress, result);
    const fit::CaptureFitOptions fit_options = fit_options_of(options, progress);
    std::optional<fit::RectifiedCapture> rectified;
    fit_stage(options, fit_options, capture, rectified, result);
    pack_and_render(options, progress, result);
    take_stage(result, "compare with the truth", [&] {
        progress("compare with the truth", 0.0);
        const rig::Rig& rig = result.calibration.rig;
        const LabTruth truth =
            lab_truth(sample_data::read_bench(options.bench), rig, reference_time_s(capture));
        result.closure =
            closure_of(truth, rig.planes->delta_m, *rectified, fit_options, result.fit);
        return fmt::format("{:.3g} % RMS", 100 * result.closure.irradiance_rms);
    });
    return result;
}

void write_lab_report(const LabDemoOptions& options,
                      const LabDemoResult& result,
                      const std::string& command_line) {
    write_page(calibration_page(result.calibration, command_line),
               in_folder(options, "calibration.html"));
    write_page(fit_page(result.fit, light_of(result.fit.lightfield.slabs.front()), command_line),
               in_folder(options, "fit.html"));
    report::Page page{"A lamp, measured on the virtual bench",
                      "Capture, calibration, fit, picture, and how far from the truth. "
                      "calibration.html and fit.html say more.",
                      {}};
    report::Section picture{"Two of the measured lamp on a road", {}, {}, {}, {}};
    picture.images.push_back(report::read_image(in_folder(options, result.picture_png),
                                                "Rendered from the fitted light field."));
    report::Table table{"Time, memory (of the process, at most so far) and error estimate",
                        {"stage", "time", "memory", "error estimate"},
                        {}};
    Json json = {{"kind", "lab_demo_report"},
                 {"program", program_version()},
                 {"command", command_line},
                 {"machine", machine()}};
    for (const Stage& stage : result.stages) {
        table.rows.push_back({stage.name, fmt::format("{:.1f} s", stage.time_s),
                              fmt::format("{:.0f} MiB", stage.peak_memory_mib),
                              stage.error_estimate});
        json["stages"].push_back({{"name", stage.name},
                                  {"time_s", stage.time_s},
                                  {"peak_memory_mib", stage.peak_memory_mib},
                                  {"error_estimate", stage.error_estimate}});
    }
    json["closure"] = closure_json(result.closure);
    json["error_budget"] = budget_json(result.closure);
    page.sections = {picture,
                     closure_section(result.closure),
                     {"Stages", {}, {}, {table}, {}},
                     {"How it was made", {}, {}, {}, command_line + "\n" + machine()}};
    write_page(page, in_folder(options, "report.html"));
    write_file(json.dump(2) + "\n", in_folder(options, "report.json"));
}

}  // namespace nearfield::app
