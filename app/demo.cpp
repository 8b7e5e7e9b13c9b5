// SPDX-License-Identifier: Apache-2.0
#include "app/demo.h"

#include "app/output.h"
#include "formats/files/error.h"
#include "formats/model/tables.h"
#include "formats/scene/scene.h"
#include "render/device.h"
#include "render/display.h"
#include "sample_data/demo_scene.h"
#include "sample_data/pictures.h"

#include <fmt/format.h>

#include <filesystem>

namespace nearfield::app {
namespace {

constexpr const char* kLuminaireFile = "headlight.luminaire.exr";
// One exposure for all views, as a photographer would set it: the wall in the hot spot, at 50
// cd/m^2, is 1.7 times what the film's curve calls white, and the road a tenth of it.
constexpr double kExposureEv = 4.6;

// Runs one stage and notes its time and the process' memory; `work` returns its error estimate in
// words.
template <typename Work>
void run_stage(DemoResult& result, const std::string& name, const Work& work) {
    Stage stage;
    stage.name = name;
    const double start_s = now_s();
    stage.error_estimate = work();
    const RunRecord record = record_run(start_s);
    stage.time_s = record.time_s;
    stage.peak_memory_mib = record.peak_memory_mib;
    result.stages.push_back(stage);
}

void write_pixels(const sample_data::PixelImage& image,
                  const DemoOptions& options,
                  const std::string& name,
                  DemoResult& result) {
    write_png(image.rgb, image.size_px, path_in(options, name));
    result.files.push_back(name);
}

void render_view(const Scene& scene,
                 const Camera& camera,
                 const DemoOptions& options,
                 const DemoProgress& progress,
                 DemoResult& result) {
    const bool is_picture = result.views.empty();
    render::RenderOptions render_options;
    render_options.size_px = is_picture ? result.size_px : result.size_px / 2;
    render_options.camera = camera.name;
    render_options.samples = options.quick ? 16 : 24;
    render_options.samples_per_pixel = options.quick ? 1 : 4;
    DemoView view;
    view.camera = camera.name;
    run_stage(result, fmt::format("render, camera \"{}\"", camera.name), [&] {
        const double start_s = now_s();
        render::RenderHooks hooks;
        hooks.progress = [&](const render::RenderProgress& at) {
            progress("render " + camera.name, at.fraction);
        };
        render::Rendered rendered = render::render(scene, render_options, hooks);
        const std::string stem = is_picture ? "picture" : "view_" + camera.name;
        Picture& picture = rendered.picture;
        picture.provenance = render::describe(scene, render_options, rendered.report);
        if (is_picture) {
            write_picture(picture, record_run(start_s), path_in(options, "picture.exr"));
            result.files.emplace_back("picture.exr");
        }
        render::DisplayOptions display_options;
        display_options.exposure_ev = kExposureEv;
        const render::Display display = render::display(picture, display_options);
        view.png = stem + ".png";
        view.exposure_ev = display.exposure_ev;
        view.report = rendered.report;
        write_pixels({picture.size_px, display.srgb}, options, view.png, result);
        return render::summary(view.report.sampling);
    });
    view.time_s = result.stages.back().time_s;
    result.views.push_back(view);
}

void make_lamp(const DemoOptions& options, const DemoProgress& progress, DemoResult& result) {
    sample_data::SimulateOptions simulate;
    // Nearer than where the beam meets the road, so that no lit point lies on S, where texels show.
    simulate.delta_m = 2.4;
    if (options.quick) {
        simulate.grid = {7, 6};
        simulate.texels = {96, 64};
    }
    run_stage(result, "simulate the headlight", [&] {
        result.lamp = sample_data::simulate_headlight(
            simulate, [&](double fraction) { progress("simulate", fraction); });
        const sample_data::WallError& wall = result.lamp.walls.back();
        return fmt::format(
            "quadrature {:.1g} relative; representation on a wall at {:g} m: median {:.2g} %",
            result.lamp.figures.quadrature_error, wall.distance_m, 100.0 * wall.median_rel);
    });
    run_stage(result, "pack", [&] {
        progress("pack", 0.0);
        Luminaire luminaire = model::pack(result.lamp.lightfield, false);
        luminaire.lightfield.provenance.command = "demo";
        write_luminaire(luminaire, record_run(now_s()), path_in(options, kLuminaireFile));
        result.files.emplace_back(kLuminaireFile);
        return std::string("exact; tables in float from sums in double");
    });
    // Straight ahead at the hot spot, above the cut-off, into the kink's side, and down to the
    // road.
    const std::vector<glm::dvec2> tangents = {
        {0.0, -0.03}, {0.0, 0.02}, {-0.14, 0.0}, {0.3, -0.05}, {0.0, -0.12}};
    run_stage(result, "pictures of the lamp", [&] {
        write_pixels(sample_data::atlas_picture(result.lamp.lightfield, 86), options,
                     "lamp_images.png", result);
        write_pixels(
            sample_data::lens_picture(result.lamp.headlight, result.lamp.lightfield, tangents, 180),
            options, "lamp_seen.png", result);
        return std::string("-");
    });
}

}  // namespace

std::string path_in(const DemoOptions& options, const std::string& name) {
    return (std::filesystem::path(options.folder) / name).string();
}

DemoResult run_demo(const DemoOptions& options, const DemoProgress& progress) {
    std::error_code failure;
    std::filesystem::create_directories(options.folder, failure);
    if (failure) {
        throw Error("cannot make folder", options.folder, {}, failure.message());
    }
    DemoResult result;
    result.size_px = options.quick ? glm::ivec2(640, 360) : glm::ivec2(960, 540);
    make_lamp(options, progress, result);
    const Scene scene =
        sample_data::make_demo_scene(kLuminaireFile, path_in(options, kLuminaireFile),
                                     result.lamp.lightfield.slabs.front().delta_m);
    run_stage(result, "write the scene", [&] {
        write_scene(scene, path_in(options, "scene.gltf"), BufferPlace::SideFile);
        result.files.insert(result.files.end(), {"scene.gltf", "scene.bin"});
        return std::string("positions in float, 1e-7 relative");
    });
    for (const Camera& camera : scene.cameras) {
        render_view(scene, camera, options, progress, result);
    }
    return result;
}

}  // namespace nearfield::app
