// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/panels.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <vector>

namespace nearfield::viewer {
namespace {

void draw_reading(const Viewer& viewer) {
    const std::optional<Reading> reading = reading_under_mouse(viewer);
    if (!reading) {
        ImGui::TextDisabled("(nothing under the mouse)\n ");
        return;
    }
    const bool is_photometric = viewer.frame->quantity == Quantity::Photometric;
    const char* unit = is_photometric ? "lx" : "W/m2";
    if (viewer.frame->knows_error())
        ImGui::Text("%.5g %s +- %.2g, bias <= %.2g", reading->irradiance_y, unit,
                    reading->sigma_rel * reading->irradiance_y,
                    reading->bias_rel * reading->irradiance_y);
    else
        ImGui::Text("about %.3g %s (draft)", reading->irradiance_y, unit);
    ImGui::Text("%.4g %s at (%.3f, %.3f, %.3f) m", reading->radiance_y,
                is_photometric ? "cd/m2" : "W/(m2 sr)", reading->position_world_m.x,
                reading->position_world_m.y, reading->position_world_m.z);
}

void draw_graph(const Viewer& viewer) {
    std::vector<float> times_ms, errors;
    for (const Shot& shot : viewer.shots) {
        times_ms.push_back(static_cast<float>(1e3 * shot.time_s));
        if (shot.error_rel)
            errors.push_back(static_cast<float>(100.0 * *shot.error_rel));
    }
    const auto plot = [](const char* unit, const std::vector<float>& values) {
        if (values.empty())
            return;
        const float most = *std::max_element(values.begin(), values.end());
        ImGui::PlotHistogram("##", values.data(), static_cast<int>(values.size()), 0,
                             fmt::format("{:.3g} {}", values.back(), unit).c_str(), 0.0F,
                             std::max(most, 1e-6F), ImVec2(-1.0F, 36.0F));
    };
    plot("ms a frame", times_ms);
    plot("% estimated error", errors);
}

void draw_passes(const render::RenderReport& report) {
    if (!ImGui::TreeNode("passes, and why"))
        return;
    for (const render::PlannedPass& pass : report.plan.passes) {
        const auto cost =
            std::find_if(report.costs.begin(), report.costs.end(),
                         [&](const render::PassReport& one) { return one.id == pass.id; });
        if (pass.is_in && cost != report.costs.end())
            ImGui::TextWrapped("%s: %.1f ms, %.1f MiB: %s", pass.name, 1e3 * cost->time_s,
                               cost->bytes / (1024.0 * 1024.0), pass.reason.c_str());
        else
            ImGui::TextDisabled("%s: out: %s", pass.name, pass.reason.c_str());
    }
    for (const render::LampPlan& lamp : report.plan.lamps)
        ImGui::TextWrapped("%s: %s; shadows: %s", lamp.name.c_str(), lamp.light_reason.c_str(),
                           lamp.has_shadows ? lamp.shadows_reason.c_str() : "none");
    for (const render::UnlitLamp& lamp : report.plan.unlit)
        ImGui::TextDisabled("%s: %s", lamp.name.c_str(), lamp.reason.c_str());
    ImGui::TreePop();
}

}  // namespace

void draw_dial_panel(Viewer& viewer, PanelState& state) {
    if (!ImGui::CollapsingHeader("Accuracy", ImGuiTreeNodeFlags_DefaultOpen))
        return;
    const int last = static_cast<int>(dials().size()) - 1;
    if (!state.dial)
        state.dial = viewer.dial;
    ImGui::SliderInt("##dial", &*state.dial, 0, last,
                     dials()[static_cast<std::size_t>(*state.dial)].name);
    const bool is_held = ImGui::IsItemActive();
    mark(state, "dial");
    if (ImGui::IsItemActivated() && viewer.progress.trials.empty() && state.commands.try_dials)
        state.commands.try_dials();
    // While it is held it says what it would cost; let go, it is taken.
    if (!is_held) {
        viewer.dial = *state.dial;
        state.dial.reset();
    }
    const int shown = state.dial.value_or(viewer.dial);
    const std::vector<DialTrial>& trials = viewer.progress.trials;
    if (static_cast<std::size_t>(shown) < trials.size()) {
        const DialTrial& trial = trials[static_cast<std::size_t>(shown)];
        ImGui::Text("costs about %.0f ms; off by %.2g %% RMS, Lab %.2g\nfrom the last position",
                    1e3 * trial.time_s, 100.0 * trial.error_rel, trial.lab);
    } else {
        ImGui::TextDisabled("what it costs: touch it");
    }
    if (ImGui::Button("try all positions") && state.commands.try_dials)
        state.commands.try_dials();
    mark(state, "try dials");
}

void draw_knowledge_panel(Viewer& viewer, PanelState& state) {
    draw_dial_panel(viewer, state);
    if (!ImGui::CollapsingHeader("Light and cost", ImGuiTreeNodeFlags_DefaultOpen))
        return;
    draw_reading(viewer);
    if (!viewer.frame)
        return;
    const Frame& frame = *viewer.frame;
    ImGui::Text("%d x %d px in %.1f ms, %s", frame.size_px.x, frame.size_px.y, 1e3 * frame.time_s,
                viewer.progress.is_final ? "refined" : "refining ...");
    draw_graph(viewer);
    draw_passes(frame.report);
    ImGui::TextDisabled("%s", frame.report.device.c_str());
}

void draw_help(Viewer& viewer) {
    if (!viewer.shows_help)
        return;
    ImGui::SetNextWindowPos(ImVec2(400, 80), ImGuiCond_Appearing);
    ImGui::Begin("Keys", &viewer.shows_help, ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::TextUnformatted(
        "left: lamp or handle; drag: orbit        middle, or shift + left: pan\n"
        "right: look around                       wheel: nearer, farther\n"
        "w a s d q e: fly                         1 ... 9: the scene's cameras\n"
        "ctrl z, ctrl y: undo, redo               ctrl s: save\n"
        "ctrl d: duplicate                        delete: remove the lamp\n"
        "space: lamp on, off                      arrows: dim, and next lamp\n"
        "x: aim at the next click                 m: measure a region\n"
        "p, l, r: picture, lux, error             i: isolux lines\n"
        "+ -: exposure                            k: keep, to compare\n"
        "ctrl while dragging a handle: steps of 5 cm, 1 degree\n"
        "tab: panels                              f1: this");
    ImGui::End();
}

void draw_message(const Viewer& viewer, glm::vec2 window) {
    const std::string& text = said(viewer);
    if (text.empty())
        return;
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const float margin = 0.4F * ImGui::GetFontSize();
    const ImVec2 at(std::max(0.5F * (window.x - size.x), margin),
                    window.y - size.y - 2.0F * margin);
    ImDrawList* list = ImGui::GetForegroundDrawList();
    list->AddRectFilled(ImVec2(at.x - margin, at.y - margin),
                        ImVec2(at.x + size.x + margin, at.y + size.y + margin),
                        IM_COL32(0, 0, 0, 200));
    list->AddText(
        at,
        viewer.progress.error.empty() ? IM_COL32(220, 220, 220, 255) : IM_COL32(255, 110, 90, 255),
        text.c_str());
}

void draw_panels(Viewer& viewer, PanelState& state, glm::vec2 window) {
    state.places.clear();
    if (viewer.shows_panels && viewer.is_open) {
        constexpr ImGuiWindowFlags kFixed =
            ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoTitleBar;
        const float width = 24.0F * ImGui::GetFontSize();
        ImGui::SetNextWindowPos(ImVec2(0, 0));
        ImGui::SetNextWindowSize(ImVec2(width, window.y));
        ImGui::Begin("left", nullptr, kFixed);
        ImGui::PushItemWidth(0.55F * width);
        draw_lamps_panel(viewer, state);
        draw_files_panel(viewer, state);
        draw_record_panel(viewer, state);
        ImGui::PopItemWidth();
        ImGui::End();
        ImGui::SetNextWindowPos(ImVec2(window.x - width, 0));
        ImGui::SetNextWindowSize(ImVec2(width, window.y));
        ImGui::Begin("right", nullptr, kFixed);
        ImGui::PushItemWidth(0.7F * width);
        draw_look_panel(viewer, state);
        draw_knowledge_panel(viewer, state);
        draw_compare_panel(viewer, state);
        ImGui::PopItemWidth();
        ImGui::End();
    }
    draw_help(viewer);
    draw_message(viewer, window);
}

}  // namespace nearfield::viewer
