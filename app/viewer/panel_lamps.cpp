// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/panels.h"
#include "app/viewer/pose.h"
#include "formats/files/error.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>

namespace nearfield::viewer {
namespace {

/// The gesture of the last widget: a new one where it has just been taken hold of.
int gesture_of_widget(Viewer& viewer) {
    if (ImGui::IsItemActivated())
        begin_gesture(viewer);
    return viewer.gesture;
}

void draw_list(Viewer& viewer, PanelState& state) {
    for (const EditedLamp& lamp : std::vector<EditedLamp>(viewer.history.now.lamps)) {
        ImGui::PushID(lamp.id);
        bool on = lamp.luminaire.on;
        if (ImGui::Checkbox("##on", &on))
            change(viewer, SetOn{lamp.id, on});
        mark(state, fmt::format("on {}", lamp.luminaire.name));
        ImGui::SameLine();
        bool is_solo = viewer.solo == lamp.id;
        if (ImGui::Checkbox("##solo", &is_solo)) {
            viewer.solo = is_solo ? std::optional(lamp.id) : std::nullopt;
            viewer.is_stale = true;
        }
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("this lamp alone");
        mark(state, fmt::format("alone {}", lamp.luminaire.name));
        ImGui::SameLine();
        if (ImGui::Selectable(lamp.luminaire.name.c_str(), viewer.selected == lamp.id))
            viewer.selected = lamp.id;
        mark(state, fmt::format("lamp {}", lamp.luminaire.name));
        ImGui::PopID();
    }
}

void draw_number(Viewer& viewer,
                 PanelState& state,
                 const char* name,
                 const EditedLamp& lamp,
                 double PoseNumbers::*number,
                 double step) {
    PoseNumbers numbers = numbers_of(lamp.luminaire.world_from_luminaire);
    double value = numbers.*number;
    if (ImGui::InputDouble(name, &value, step, 10.0 * step, "%.4f",
                           ImGuiInputTextFlags_EnterReturnsTrue)) {
        numbers.*number = value;
        change(viewer, SetPose{lamp.id, pose_of(numbers)});
    }
    mark(state, name);
}

void draw_position(Viewer& viewer, PanelState& state, const EditedLamp& lamp) {
    constexpr std::array<const char*, 3> kNames = {"x m", "y m", "z m"};
    for (int axis = 0; axis < 3; ++axis) {
        glm::dmat4 pose = lamp.luminaire.world_from_luminaire;
        const char* name = kNames[static_cast<std::size_t>(axis)];
        if (ImGui::InputDouble(name, &pose[3][axis], 0.01, 0.1, "%.4f",
                               ImGuiInputTextFlags_EnterReturnsTrue))
            change(viewer, SetPose{lamp.id, pose});
        mark(state, name);
    }
}

void draw_light(Viewer& viewer, PanelState& state, const EditedLamp& lamp) {
    double dim = lamp.luminaire.dim;
    const double least = 0.0, most = 2.0;
    const bool is_dimmed =
        ImGui::SliderScalar("dim", ImGuiDataType_Double, &dim, &least, &most, "%.3f");
    const int dim_gesture = gesture_of_widget(viewer);
    if (is_dimmed)
        change(viewer, SetDim{lamp.id, dim}, dim_gesture);
    mark(state, "dim");
    glm::vec3 tint = lamp.luminaire.tint;
    const bool is_tinted = ImGui::ColorEdit3("tint", &tint.x, ImGuiColorEditFlags_Float);
    const int tint_gesture = gesture_of_widget(viewer);
    if (is_tinted)
        change(viewer, SetTint{lamp.id, glm::clamp(tint, 0.0F, 1.0F)}, tint_gesture);
    mark(state, "tint");
}

void draw_partner(Viewer& viewer, PanelState& state, const EditedLamp& lamp) {
    if (lamp.mirror) {
        if (ImGui::Button("part from partner"))
            change(viewer, PartPartners{lamp.id});
        return;
    }
    if (ImGui::Button("mirror image in x = 0"))
        change(viewer, AddMirrorImage{lamp.id});
    mark(state, "mirror image");
    for (const EditedLamp& other : std::vector<EditedLamp>(viewer.history.now.lamps)) {
        if (other.id == lamp.id)
            continue;
        if (ImGui::Button(fmt::format("moves mirrored: {}", other.luminaire.name).c_str()))
            change(viewer, MakePartners{lamp.id, other.id});
        mark(state, fmt::format("partner {}", other.luminaire.name));
    }
}

// `lamp`: a copy, which what is changed meanwhile does not move.
void draw_selected(Viewer& viewer, PanelState& state, const EditedLamp& lamp) {
    std::string name = lamp.luminaire.name;
    if (ImGui::InputText("name", &name, ImGuiInputTextFlags_EnterReturnsTrue))
        change(viewer, SetName{lamp.id, name});
    mark(state, "name");
    ImGui::TextDisabled("%s", lamp.luminaire.uri.c_str());
    draw_position(viewer, state, lamp);
    draw_number(viewer, state, "yaw deg", lamp, &PoseNumbers::yaw_deg, 0.1);
    draw_number(viewer, state, "pitch deg", lamp, &PoseNumbers::pitch_deg, 0.1);
    draw_number(viewer, state, "roll deg", lamp, &PoseNumbers::roll_deg, 0.1);
    draw_light(viewer, state, lamp);
    ImGui::Checkbox("handles along the lamp's axes", &viewer.has_lamps_axes);
    bool is_aiming = viewer.tool == Tool::Aim;
    if (ImGui::Checkbox("aim at the next click", &is_aiming))
        viewer.tool = is_aiming ? Tool::Aim : Tool::Select;
    mark(state, "aim");
    if (ImGui::Button("duplicate"))
        change(viewer, Duplicate{lamp.id, {0.3, 0.0, 0.0}});
    mark(state, "duplicate");
    ImGui::SameLine();
    if (ImGui::Button("remove"))
        change(viewer, Remove{lamp.id});
    mark(state, "remove");
    draw_partner(viewer, state, lamp);
}

}  // namespace

void mark(PanelState& state, const std::string& name) {
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    state.places[name] = {low.x, low.y, high.x, high.y};
}

void draw_lamps_panel(Viewer& viewer, PanelState& state) {
    if (!ImGui::CollapsingHeader("Lamps", ImGuiTreeNodeFlags_DefaultOpen))
        return;
    draw_list(viewer, state);
    const EditedLamp* lamp =
        viewer.selected ? find_lamp(viewer.history.now, *viewer.selected) : nullptr;
    if (lamp != nullptr)
        draw_selected(viewer, state, EditedLamp(*lamp));
}

void draw_files_panel(Viewer& viewer, PanelState& state) {
    if (!ImGui::CollapsingHeader("File", ImGuiTreeNodeFlags_DefaultOpen))
        return;
    const History& history = viewer.history;
    ImGui::TextWrapped("%s%s",
                       history.now.path.empty() ? "(stock scene)" : history.now.path.c_str(),
                       is_unsaved(viewer) ? " *" : "");
    if (ImGui::Button(history.past.empty()
                          ? "undo##undo"
                          : fmt::format("undo {}##undo", history.past.back().name).c_str()))
        undo(viewer);
    mark(state, "undo");
    ImGui::SameLine();
    if (ImGui::Button(history.future.empty()
                          ? "redo##redo"
                          : fmt::format("redo {}##redo", history.future.back().name).c_str()))
        redo(viewer);
    mark(state, "redo");
    ImGui::InputTextWithHint("##save", "path, or where it came from", &state.save_path);
    mark(state, "save path");
    ImGui::SameLine();
    if (ImGui::Button("save")) {
        try {
            save(viewer, state.save_path.empty() ? history.now.path : state.save_path);
        } catch (const Error& error) {
            viewer.message = error.what();
        }
    }
    mark(state, "save");
    ImGui::InputTextWithHint("##open", "scene or luminaire", &state.open_path);
    mark(state, "open path");
    ImGui::SameLine();
    if (ImGui::Button("open / add") && state.commands.open)
        state.commands.open(state.open_path);
    mark(state, "open");
}

void draw_record_panel(const Viewer& viewer, PanelState& state) {
    if (!ImGui::CollapsingHeader("Record"))
        return;
    const Commands& commands = state.commands;
    ImGui::InputText("##picture", &state.picture_path);
    ImGui::SameLine();
    if (ImGui::Button("write picture") && commands.write_picture)
        commands.write_picture(state.picture_path);
    mark(state, "write picture");
    ImGui::InputText("frames", &state.frames_prefix);
    mark(state, "frames");
    ImGui::InputInt("how many", &state.frames);
    state.frames = std::clamp(state.frames, 1, 9999);
    if (ImGui::Button("turntable") && commands.record_turntable)
        commands.record_turntable(state.frames_prefix, state.frames);
    mark(state, "turntable");
    ImGui::SameLine();
    if (ImGui::Button("sweep of the lamp") && commands.record_sweep)
        commands.record_sweep(state.frames_prefix, state.frames, state.sweep_deg);
    mark(state, "sweep");
    ImGui::InputDouble("deg of sweep", &state.sweep_deg, 1.0, 10.0, "%.1f");
    if (viewer.progress.whole_left > 0)
        ImGui::Text("%d more to be written", viewer.progress.whole_left);
}

}  // namespace nearfield::viewer
