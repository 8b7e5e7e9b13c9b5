// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/record.h"

#include "app/viewer/pose.h"
#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/image.h"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include <utility>
#include <vector>

namespace nearfield::viewer {
namespace {

bool is_exr(const std::string& path) {
    return path.ends_with(".exr");
}

/// Of the dial's position, as the command line says them.
std::string options_text(const Quality& quality) {
    return fmt::format(" --q {} --shadow-maps {} --shadow-map-px {} --shadow-taps {}{}", quality.q,
                       quality.shadow_maps.maps, quality.shadow_maps.map_px,
                       quality.shadow_maps.pcf_taps,
                       quality.has_gloss ? "" : " --effect gloss=off");
}

void write(render::Rendered rendered,
           const Scene& scene,
           const render::RenderOptions& options,
           const render::DisplayOptions& display,
           const std::string& path) {
    if (is_exr(path)) {
        rendered.picture.provenance = render::describe(scene, options, rendered.report);
        nearfield::write_picture(rendered.picture, std::nullopt, path);
        return;
    }
    write_png(render::display(rendered.picture, display).srgb, rendered.picture.size_px, path);
}

void ask(Worker& worker,
         Request request,
         const render::DisplayOptions& display,
         const std::string& path) {
    const Scene scene = edited_scene(request.document);
    const render::RenderOptions options =
        options_of(dials()[static_cast<std::size_t>(request.dial)].quality, request.size_px);
    worker.render(std::move(request), [=](render::Rendered rendered) {
        write(std::move(rendered), scene, options, display, path);
    });
}

/// One exposure for all frames.
render::DisplayOptions fixed_exposure(const Viewer& viewer) {
    render::DisplayOptions display = viewer.look.display;
    display.exposure_ev = display.exposure_ev.value_or(viewer.developed.exposure_ev);
    return display;
}

std::string frame_name(const std::string& prefix, int frame) {
    return fmt::format("{}_{:03}", prefix, frame + 1);
}

void ask(Worker& worker,
         std::vector<Request> frames,
         const render::DisplayOptions& display,
         const std::string& prefix) {
    for (std::size_t k = 0; k < frames.size(); ++k)
        ask(worker, std::move(frames[k]), display,
            frame_name(prefix, static_cast<int>(k)) + ".png");
}

/// What makes a frame again without a window, a line of a script.
std::string command_of(const Request& request,
                       const render::DisplayOptions& display,
                       const std::string& scene,
                       const std::string& frame) {
    return fmt::format(
        "nearfield render '{}' --device gl --show-lamps{} --camera '{}' --width {} --height {} "
        "--tonemap {} --exposure-ev {} -o '{}.exr' --png '{}.png'\n",
        scene, options_text(dials()[static_cast<std::size_t>(request.dial)].quality),
        request.camera.name, request.size_px.x, request.size_px.y,
        display.tonemap == render::ToneMap::Papers ? "papers" : "filmic", *display.exposure_ev,
        frame, frame);
}

}  // namespace

void write_shown(const Viewer& viewer, const std::string& path) {
    const Developed& shown = viewer.developed;
    std::vector<unsigned char> rgb;
    rgb.reserve(shown.rgba.size() / 4 * 3);
    for (std::size_t k = 0; k < shown.rgba.size(); k += 4)
        rgb.insert(rgb.end(), {shown.rgba[k], shown.rgba[k + 1], shown.rgba[k + 2]});
    write_png(rgb, shown.size_px, path);
}

void write_picture_by(Worker& worker,
                      const Viewer& viewer,
                      glm::ivec2 size_px,
                      const std::string& path) {
    ask(worker, request_of(viewer, size_px), viewer.look.display, path);
}

void record_turntable(Worker& worker,
                      const Viewer& viewer,
                      glm::ivec2 size_px,
                      const std::string& prefix,
                      int frames) {
    Document document = viewer.history.now;
    const render::DisplayOptions display = fixed_exposure(viewer);
    const std::string scene = prefix + ".gltf";
    std::string script = "#!/bin/sh\n# Renders the frames of a turntable.\n";
    std::vector<Request> requests;
    for (int k = 0; k < frames; ++k) {
        Request request = request_of(viewer, size_px);
        request.camera = orbited(viewer.view, glm::two_pi<double>() * k / frames, 0.0).camera;
        request.camera.name = fmt::format("turntable {:03}", k + 1);
        document.bookmarks.push_back(request.camera);
        script += command_of(request, display, scene, frame_name(prefix, k));
        requests.push_back(std::move(request));
    }
    save_document(document, scene);
    write_file(script, prefix + ".sh");
    ask(worker, std::move(requests), display, prefix);
}

void record_sweep(Worker& worker,
                  const Viewer& viewer,
                  glm::ivec2 size_px,
                  const std::string& prefix,
                  int frames,
                  int lamp,
                  double span_deg) {
    const EditedLamp* swept = find_lamp(viewer.history.now, lamp);
    if (swept == nullptr)
        throw Error{"cannot record a sweep", "lamp", "one that is selected", "none"};
    const PoseNumbers middle = numbers_of(swept->luminaire.world_from_luminaire);
    const render::DisplayOptions display = fixed_exposure(viewer);
    std::string script = "#!/bin/sh\n# Renders the frames of a lamp's sweep.\n";
    std::vector<Request> requests;
    for (int k = 0; k < frames; ++k) {
        PoseNumbers numbers = middle;
        numbers.yaw_deg += frames > 1 ? span_deg * (k / (frames - 1.0) - 0.5) : 0.0;
        Request request = request_of(viewer, size_px);
        request.document = edited(request.document, SetPose{lamp, pose_of(numbers)});
        request.camera.name = "sweep";
        Document document = request.document;
        document.bookmarks.push_back(request.camera);
        const std::string frame = frame_name(prefix, k);
        save_document(document, frame + ".gltf");
        script += command_of(request, display, frame + ".gltf", frame);
        requests.push_back(std::move(request));
    }
    write_file(script, prefix + ".sh");
    ask(worker, std::move(requests), display, prefix);
}

}  // namespace nearfield::viewer
