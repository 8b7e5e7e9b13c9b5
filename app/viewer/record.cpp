// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/record.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/image.h"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

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
    // One exposure for all of them.
    render::DisplayOptions display = viewer.look.display;
    display.exposure_ev = display.exposure_ev.value_or(viewer.developed.exposure_ev);
    const std::string scene = prefix + ".gltf";
    std::string script = "#!/bin/sh\n# Renders the frames of a turntable.\n";
    for (int k = 0; k < frames; ++k) {
        Request request = request_of(viewer, size_px);
        request.camera = orbited(viewer.view, glm::two_pi<double>() * k / frames, 0.0).camera;
        request.camera.name = fmt::format("turntable {:03}", k + 1);
        document.bookmarks.push_back(request.camera);
        const std::string frame = fmt::format("{}_{:03}", prefix, k + 1);
        script += fmt::format(
            "nearfield render '{}' --device gl{} --camera '{}' --width {} --height {} "
            "--exposure-ev {} -o '{}.exr' --png '{}.png'\n",
            scene, options_text(dials()[static_cast<std::size_t>(viewer.dial)].quality),
            request.camera.name, size_px.x, size_px.y, *display.exposure_ev, frame, frame);
        ask(worker, std::move(request), display, frame + ".png");
    }
    save_document(document, scene);
    write_file(script, prefix + ".sh");
}

}  // namespace nearfield::viewer
