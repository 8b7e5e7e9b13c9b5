// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/panels.h"
#include "formats/files/error.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::viewer {
namespace {

constexpr double kOrbit_rad_per_px = 0.005, kLook_rad_per_px = 0.003, kDollyPerNotch = 0.9;
constexpr double kPickWithin_px = 14.0;
constexpr double kMoveStep_m = 0.05, kTurnStep_deg = 1.0;

const EditedLamp* selected_lamp(const Viewer& viewer) {
    return viewer.selected ? find_lamp(viewer.history.now, *viewer.selected) : nullptr;
}

bool is_pressed(int key) {
    return ImGui::IsKeyPressed(key, false);
}

void press_in_picture(Viewer& viewer, const Ray& ray, glm::dvec2 at_px, glm::vec2 window) {
    const glm::dvec2 at = at_px / glm::dvec2(window);
    if (viewer.tool == Tool::Measure) {
        viewer.region = {at, at};
        return;
    }
    if (viewer.tool == Tool::Aim) {
        const std::optional<glm::dvec3> point = surface_at(viewer, at);
        if (point && viewer.selected)
            change(viewer, Aim{*viewer.selected, *point});
        viewer.tool = Tool::Select;
        return;
    }
    if (const EditedLamp* lamp = selected_lamp(viewer); lamp != nullptr && viewer.hot) {
        const glm::dmat4& pose = lamp->luminaire.world_from_luminaire;
        begin_gesture(viewer);
        viewer.drag =
            Drag{*viewer.hot, gizmo_of(pose, viewer.view.camera, viewer.has_lamps_axes), pose, ray};
        return;
    }
    const std::optional<int> lamp =
        lamp_at(viewer.history.now, viewer.view.camera, glm::ivec2(window), at_px, kPickWithin_px);
    if (lamp)
        viewer.selected = lamp;
}

void hover(Viewer& viewer, const Ray& ray) {
    const EditedLamp* lamp = selected_lamp(viewer);
    viewer.hot = lamp == nullptr || !viewer.shows_panels
                     ? std::nullopt
                     : handle_at(gizmo_of(lamp->luminaire.world_from_luminaire, viewer.view.camera,
                                          viewer.has_lamps_axes),
                                 ray);
}

void drag_in_picture(Viewer& viewer, const Ray& ray, glm::dvec2 at, glm::vec2 window) {
    const ImGuiIO& io = ImGui::GetIO();
    const glm::dvec2 by(io.MouseDelta.x, io.MouseDelta.y);
    const bool has_moved = by != glm::dvec2(0.0);
    if (viewer.drag && viewer.selected) {
        const bool moves = viewer.drag->handle.kind == HandleKind::Move;
        const double step = io.KeyCtrl ? (moves ? kMoveStep_m : kTurnStep_deg) : 0.0;
        if (has_moved)
            change(viewer, SetPose{*viewer.selected, dragged(*viewer.drag, ray, step)},
                   viewer.gesture);
    } else if (viewer.tool == Tool::Measure && viewer.region) {
        viewer.region->second = at;
    } else if (has_moved) {
        viewer.view = io.KeyShift ? panned(viewer.view, by, static_cast<int>(window.y))
                                  : orbited(viewer.view, -kOrbit_rad_per_px * by.x,
                                            -kOrbit_rad_per_px * by.y);
    }
}

void handle_mouse(Viewer& viewer, glm::vec2 window) {
    const ImGuiIO& io = ImGui::GetIO();
    const glm::dvec2 at_px(io.MousePos.x, io.MousePos.y), at = at_px / glm::dvec2(window);
    const bool is_over = !io.WantCaptureMouse;
    viewer.mouse = is_over && ImGui::IsMousePosValid() ? std::optional(at) : std::nullopt;
    const Ray ray = ray_through(viewer.view.camera, glm::ivec2(window), at_px);
    if (is_over && !viewer.drag)
        hover(viewer, ray);
    if (is_over && ImGui::IsMouseClicked(0))
        press_in_picture(viewer, ray, at_px, window);
    if (is_over && ImGui::IsMouseDown(0))
        drag_in_picture(viewer, ray, at, window);
    if (!ImGui::IsMouseDown(0))
        viewer.drag.reset();
    const glm::dvec2 by(io.MouseDelta.x, io.MouseDelta.y);
    if (is_over && ImGui::IsMouseDown(1) && by != glm::dvec2(0.0))
        viewer.view =
            looked_around(viewer.view, -kLook_rad_per_px * by.x, -kLook_rad_per_px * by.y);
    if (is_over && ImGui::IsMouseDown(2) && by != glm::dvec2(0.0))
        viewer.view = panned(viewer.view, by, static_cast<int>(window.y));
    if (is_over && io.MouseWheel != 0.0F)
        viewer.view =
            dollied(viewer.view, std::pow(kDollyPerNotch, static_cast<double>(io.MouseWheel)));
}

/// Right, up, ahead.
glm::dvec3 held_direction() {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput || io.KeyCtrl)
        return glm::dvec3(0.0);
    const auto held = [](int key) { return ImGui::IsKeyDown(key) ? 1.0 : 0.0; };
    return {held(GLFW_KEY_D) - held(GLFW_KEY_A), held(GLFW_KEY_E) - held(GLFW_KEY_Q),
            held(GLFW_KEY_W) - held(GLFW_KEY_S)};
}

void fly(Viewer& viewer) {
    // A step is a share of the pivot's distance, so that rooms and roads feel alike.
    const double step = 0.02 * viewer.view.distance_m;
    viewer.view = flown(viewer.view, step * held_direction());
}

void handle_control_keys(Viewer& viewer, PanelState& state) {
    if (is_pressed(GLFW_KEY_Z))
        ImGui::GetIO().KeyShift ? redo(viewer) : undo(viewer);
    if (is_pressed(GLFW_KEY_Y))
        redo(viewer);
    if (is_pressed(GLFW_KEY_Q) && state.commands.quit)
        state.commands.quit();
    if (is_pressed(GLFW_KEY_D) && viewer.selected)
        change(viewer, Duplicate{*viewer.selected, {0.3, 0.0, 0.0}});
    if (!is_pressed(GLFW_KEY_S))
        return;
    try {
        save(viewer, state.save_path.empty() ? viewer.history.now.path : state.save_path);
    } catch (const Error& error) {
        viewer.message = error.what();
    }
}

void handle_lamp_keys(Viewer& viewer) {
    const EditedLamp* lamp = selected_lamp(viewer);
    if (lamp == nullptr)
        return;
    const int id = lamp->id;
    const double dim = lamp->luminaire.dim;
    if (is_pressed(GLFW_KEY_SPACE))
        change(viewer, SetOn{id, !lamp->luminaire.on});
    else if (is_pressed(GLFW_KEY_DELETE))
        change(viewer, Remove{id});
    else if (is_pressed(GLFW_KEY_UP) || is_pressed(GLFW_KEY_DOWN))
        change(viewer, SetDim{id, std::max(dim + (is_pressed(GLFW_KEY_UP) ? 0.05 : -0.05), 0.0)});
    else if (is_pressed(GLFW_KEY_RIGHT) || is_pressed(GLFW_KEY_LEFT)) {
        const std::vector<EditedLamp>& lamps = viewer.history.now.lamps;
        const auto at = static_cast<std::size_t>(lamp - lamps.data());
        const std::size_t step = is_pressed(GLFW_KEY_RIGHT) ? 1 : lamps.size() - 1;
        viewer.selected = lamps[(at + step) % lamps.size()].id;
    }
}

void handle_look_keys(Viewer& viewer) {
    const Look before = viewer.look;
    constexpr std::pair<int, Shown> kShown[] = {
        {GLFW_KEY_P, Shown::Picture}, {GLFW_KEY_L, Shown::Lux}, {GLFW_KEY_R, Shown::Error}};
    for (const auto& [key, shown] : kShown)
        if (is_pressed(key))
            viewer.look.shown = shown;
    if (is_pressed(GLFW_KEY_I))
        viewer.look.has_isolux = !viewer.look.has_isolux;
    const double brighter =
        (is_pressed(GLFW_KEY_EQUAL) ? 1.0 : 0.0) - (is_pressed(GLFW_KEY_MINUS) ? 1.0 : 0.0);
    if (brighter != 0.0)
        viewer.look.display.exposure_ev =
            viewer.look.display.exposure_ev.value_or(viewer.developed.exposure_ev) - 0.5 * brighter;
    viewer.is_stale = viewer.is_stale || !(viewer.look == before);
    const std::vector<Camera>& cameras = viewer.history.now.scene->cameras;
    for (std::size_t k = 0; k < std::min<std::size_t>(cameras.size(), 9); ++k)
        if (is_pressed(GLFW_KEY_1 + static_cast<int>(k)))
            viewer.view = {cameras[k], viewer.view.distance_m};
    if (is_pressed(GLFW_KEY_X))
        viewer.tool = Tool::Aim;
    if (is_pressed(GLFW_KEY_M))
        viewer.tool = viewer.tool == Tool::Measure ? Tool::Select : Tool::Measure;
    if (is_pressed(GLFW_KEY_K))
        keep_state(viewer);
}

}  // namespace

void handle_input(Viewer& viewer, PanelState& state, glm::vec2 window) {
    if (!viewer.is_open)
        return;
    handle_mouse(viewer, window);
    if (ImGui::GetIO().WantTextInput)
        return;
    if (is_pressed(GLFW_KEY_F1))
        viewer.shows_help = !viewer.shows_help;
    if (is_pressed(GLFW_KEY_TAB))
        viewer.shows_panels = !viewer.shows_panels;
    if (ImGui::GetIO().KeyCtrl) {
        handle_control_keys(viewer, state);
        return;
    }
    handle_lamp_keys(viewer);
    handle_look_keys(viewer);
    if (is_flying())
        fly(viewer);
}

bool is_flying() {
    return held_direction() != glm::dvec3(0.0);
}

}  // namespace nearfield::viewer
