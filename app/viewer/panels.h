// SPDX-License-Identifier: Apache-2.0
/// What is drawn over the picture. Panels read the state and call what viewer.h declares; they need
/// an ImGui context and no window.
#pragma once

#include "app/viewer/viewer.h"

#include <glm/glm.hpp>

#include <functional>
#include <map>
#include <optional>
#include <string>

namespace nearfield::viewer {

/// What panels ask of whoever runs them.
struct Commands {
    std::function<void(const std::string& path)> open;  // scene or lamp, by a thread
    std::function<void()> try_dials;
    std::function<void(const std::string& path)> write_picture;  // .png or .exr, by the renderer
    std::function<void(const std::string& prefix, int frames)> record_turntable;
    std::function<void(const std::string& prefix, int frames, double span_deg)> record_sweep;
    std::function<void(const std::string& path)> compare_with;  // an .exr
    std::function<void()> quit;
};

struct PanelState {
    Commands commands;
    std::string open_path, save_path, picture_path = "picture.png", frames_prefix = "frames",
                                      reference_path;
    int frames = 36;
    double sweep_deg = 10;
    std::optional<int> dial;  // while it is held
    /// Where widgets are in the window, by name: for those that drive it.
    std::map<std::string, glm::vec4> places;  // left, top, right, bottom
};

/// Notes where the last widget is.
void mark(PanelState& state, const std::string& name);

/// All of them, on a window of that size.
void draw_panels(Viewer& viewer, PanelState& state, glm::vec2 window);

void draw_lamps_panel(Viewer& viewer, PanelState& state);
void draw_files_panel(Viewer& viewer, PanelState& state);
void draw_record_panel(const Viewer& viewer, PanelState& state);
void draw_look_panel(Viewer& viewer, PanelState& state);
void draw_compare_panel(Viewer& viewer, PanelState& state);
void draw_dial_panel(Viewer& viewer, PanelState& state);
void draw_knowledge_panel(Viewer& viewer, PanelState& state);
void draw_help(Viewer& viewer);
/// At the lower edge, above everything.
void draw_message(const Viewer& viewer, glm::vec2 window);

/// Handles, lamps' places, the region, the scale: over the picture, which fills the window.
void draw_overlay(const Viewer& viewer, PanelState& state, glm::vec2 window);

/// Mouse and keys that no panel wants.
void handle_input(Viewer& viewer, PanelState& state, glm::vec2 window);
/// Whether a key is held that moves the view on and on.
bool is_flying();

}  // namespace nearfield::viewer
