// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/run.h"

#include "app/viewer/memory.h"
#include "app/viewer/panels.h"
#include "app/viewer/record.h"
#include "app/viewer/trace.h"
#include "app/viewer/window.h"
#include "formats/files/error.h"
#include "formats/files/image.h"
#include "formats/files/provenance.h"
#include "render/film.h"

#include <fmt/format.h>
#include <imgui.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <utility>

namespace nearfield::viewer {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesAfterEvent = 3;  // until ImGui has settled: hovers, popups, activations
constexpr double kAutosave_s = 3.0, kCursor_s = 0.4, kFly_s = 0.016;

bool is_scene(const std::string& path) {
    return path.ends_with(".gltf") || path.ends_with(".glb");
}

/// A running viewer.
struct Run {
    const ViewerOptions& options;
    Window window;
    Viewer viewer;
    PanelState panels;
    Trace trace;
    std::optional<Request> asked = std::nullopt;   // of the renderer, the last
    std::shared_ptr<const Frame> shown = nullptr;  // the last
    std::future<Opened> opening = {};
    std::future<void> autosaving = {};
    std::string autosaved = {};  // a file of this run's; empty: none
    double changed_s = 0;        // when the document was seen to differ from the autosave
    int frames_left = kFramesAfterEvent;
    bool is_written = false;  // the screenshots
    Worker worker{&Window::wake};
};

/// Does it, or says why not.
template <typename Work>
void attempt(Run& run, const Work& work) {
    try {
        work();
    } catch (const Error& error) {
        run.viewer.message = error.what();
    }
}

void open(Run& run, const std::string& path) {
    if (run.viewer.is_open && !is_scene(path)) {
        attempt(run, [&] {
            glm::dmat4 pose(1.0);
            pose[3] = glm::dvec4(pivot_of(run.viewer.view), 1.0);
            change(run.viewer, Add{lamp_of(path, pose)});
        });
        return;
    }
    run.viewer.message = fmt::format("opening {} ...", path);
    run.opening = std::async(std::launch::async, [path] {
        struct Wake {
            ~Wake() { Window::wake(); }
        } at_end;
        return open_document(path);
    });
}

bool is_ready(const std::future<Opened>& opening) {
    return opening.valid() &&
           opening.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void finish_opening(Run& run) {
    if (!is_ready(run.opening))
        return;
    try {
        take(run.viewer, run.opening.get());
        run.window.set_title("nearfield: " + run.viewer.history.now.path);
        const std::string autosaved = autosave_path(run.viewer.history.now.path);
        if (fs::exists(autosaved))
            run.viewer.message = "unsaved work of another time is in " + autosaved;
    } catch (const Error& error) {
        if (!run.viewer.is_open)
            throw;
        run.viewer.message = error.what();  // the last good picture stays
    }
}

/// Asks the renderer for what is not yet asked for.
void ask(Run& run) {
    const glm::ivec2 size_px = run.window.size_px();
    if (!run.viewer.is_open || size_px.x < 1 || size_px.y < 1)
        return;
    Request request = request_of(run.viewer, size_px);
    if (run.asked && is_lit_alike(*run.asked, request))
        return;
    request.serial = ++run.viewer.serial;
    run.trace.asked(request);
    run.asked = request;
    run.worker.show(std::move(request));
}

void show_frame(Run& run) {
    if (!refresh(run.viewer, run.worker.progress()))
        return;
    run.window.set_picture(run.viewer.developed);
    ++run.frames_left;
}

bool is_running(const std::future<void>& work) {
    return work.valid() && work.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

/// Keeps unsaved work in a file beside the scene's, until it is saved.
void autosave(Run& run) {
    Viewer& viewer = run.viewer;
    if (is_running(run.autosaving))
        return;
    if (!is_unsaved(viewer) && !run.autosaved.empty()) {
        std::error_code failed;
        fs::remove(std::exchange(run.autosaved, {}), failed);
    }
    const bool is_due = viewer.changes != viewer.autosaved_changes && is_unsaved(viewer) &&
                        !viewer.history.now.path.empty();
    if (!is_due) {
        run.changed_s = 0.0;
        return;
    }
    if (run.changed_s == 0.0)
        run.changed_s = now_s();
    if (now_s() - run.changed_s < kAutosave_s)
        return;
    viewer.autosaved_changes = viewer.changes;
    run.autosaved = autosave_path(viewer.history.now.path);
    run.autosaving = std::async(std::launch::async, [document = viewer.history.now] {
        try {
            save_document(document, autosave_path(document.path));
        } catch (const Error&) {
            // Saving by hand will say why.
        }
    });
}

/// How long the loop may sleep: below 0, until something happens.
double sleep_s(const Run& run) {
    if (run.frames_left > 0 || run.window.has_events())
        return 0.0;
    if (ImGui::GetIO().WantTextInput)
        return kCursor_s;
    if (is_flying())
        return kFly_s;
    return run.changed_s > 0.0 ? kAutosave_s : -1.0;
}

/// Once the picture is refined: what the command line asked for.
void write_screenshots(Run& run) {
    const Viewer& viewer = run.viewer;
    if (run.is_written || !viewer.frame || !viewer.progress.is_final ||
        viewer.frame->serial != viewer.serial || run.frames_left > 0)
        return;
    if (!viewer.progress.error.empty())
        throw Error{"cannot render", viewer.progress.error};
    run.is_written = true;
    if (!run.options.screenshot.empty())
        write_shown(viewer, run.options.screenshot);
    if (!run.options.window_screenshot.empty())
        write_png(run.window.pixels(), run.window.size_px(), run.options.window_screenshot);
    if (run.options.exits)
        run.window.close();
}

void draw(Run& run) {
    run.window.begin();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const glm::vec2 window(size.x, size.y);
    run.trace.saw_input();
    draw_panels(run.viewer, run.panels, window);
    handle_input(run.viewer, run.panels, window);
    ask(run);  // before all else is drawn: the renderer begins in the meantime
    show_frame(run);
    run.window.draw_picture();
    draw_overlay(run.viewer, run.panels, window);
    run.window.end();
    write_screenshots(run);
    run.window.swap();
    run.trace.placed(run.panels.places);
    run.trace.said(said(run.viewer));
    if (run.viewer.frame && run.viewer.frame != run.shown) {
        run.shown = run.viewer.frame;
        run.trace.showed(*run.shown, run.viewer.progress.is_final);
    }
}

void bind_commands(Run& run) {
    Commands& commands = run.panels.commands;
    commands.open = [&run](const std::string& path) { open(run, path); };
    commands.quit = [&run] { run.window.close(); };
    commands.try_dials = [&run] {
        run.worker.try_dials(request_of(run.viewer, run.window.size_px()));
    };
    commands.write_picture = [&run](const std::string& path) {
        write_picture_by(run.worker, run.viewer, run.window.size_px(), path);
    };
    commands.record_turntable = [&run](const std::string& prefix, int frames) {
        attempt(run, [&] {
            record_turntable(run.worker, run.viewer, run.window.size_px(), prefix, frames);
        });
    };
    commands.record_sweep = [&run](const std::string& prefix, int frames, double span_deg) {
        attempt(run, [&] {
            record_sweep(run.worker, run.viewer, run.window.size_px(), prefix, frames,
                         run.viewer.selected.value_or(-1), span_deg);
        });
    };
    commands.compare_with = [&run](const std::string& path) {
        attempt(run, [&] { compare_with(run.viewer, path); });
    };
    run.window.on_drop([&run](const std::string& path) { open(run, path); });
}

WindowPlace place_for(const ViewerOptions& options) {
    WindowPlace place;
    if (options.remembers)
        place = remembered_place().value_or(place);
    if (options.size_px)
        place = WindowPlace{*options.size_px, true, {0, 0}};
    return place;
}

void begin_with(Run& run) {
    const ViewerOptions& options = run.options;
    run.viewer.dial = options.dial;
    run.viewer.look.display.exposure_ev = options.exposure_ev;
    open(run, options.path);
    run.opening.wait();  // a file that is wrong at the start ends the program
    finish_opening(run);
    if (!options.camera.empty())
        run.viewer.view = {
            render::find_camera(edited_scene(run.viewer.history.now), options.camera), 6.0};
    for (const std::string& lamp : options.lamps)
        open(run, lamp);
}

}  // namespace

void run_viewer(const ViewerOptions& options) {
    Run run{options, Window(place_for(options)), {}, {}, Trace(options.trace)};
    bind_commands(run);
    begin_with(run);
    while (!run.window.is_closing()) {
        const double timeout_s = sleep_s(run);
        run.window.wait(timeout_s);
        run.trace.woke();
        run.frames_left = timeout_s == 0.0 ? run.frames_left - 1 : kFramesAfterEvent;
        finish_opening(run);
        draw(run);
        autosave(run);
    }
    if (run.autosaving.valid())
        run.autosaving.wait();
    autosave(run);  // which removes its file where all is saved
    if (options.remembers)
        remember_place(run.window.place());
}

}  // namespace nearfield::viewer
