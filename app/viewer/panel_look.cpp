// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/panels.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

namespace nearfield::viewer {
namespace {

void same_line_if_there_is_room() {
    const float end = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    if (ImGui::GetItemRectMax().x + 7.0F * ImGui::GetFontSize() < end)
        ImGui::SameLine();
}

void draw_cameras(Viewer& viewer, PanelState& state) {
    const Document& document = viewer.history.now;
    const auto button = [&](const std::string& name, const View& view) {
        if (ImGui::SmallButton(name.c_str()))
            viewer.view = view;
        mark(state, "camera " + name);
        same_line_if_there_is_room();
    };
    for (const Camera& camera : document.scene->cameras)
        button(camera.name, {camera, viewer.view.distance_m});
    for (const Camera& camera : document.bookmarks)
        button(camera.name, {camera, viewer.view.distance_m});
    button("driver's eye", drivers_view(document));
    button("bird's eye", birds_view(document));
    if (ImGui::SmallButton("+ bookmark")) {
        Camera camera = viewer.view.camera;
        camera.name = "bookmark";
        change(viewer, AddBookmark{camera});
    }
    mark(state, "bookmark");
}

void draw_exposure(Viewer& viewer, PanelState& state) {
    render::DisplayOptions& display = viewer.look.display;
    bool is_automatic = !display.exposure_ev;
    if (ImGui::Checkbox("auto", &is_automatic))
        display.exposure_ev =
            is_automatic ? std::nullopt : std::optional(viewer.developed.exposure_ev);
    mark(state, "automatic exposure");
    ImGui::SameLine();
    auto exposure_ev =
        static_cast<float>(display.exposure_ev.value_or(viewer.developed.exposure_ev));
    if (ImGui::SliderFloat("EV", &exposure_ev, -6.0F, 16.0F, "%.2f"))
        display.exposure_ev = static_cast<double>(exposure_ev);
    mark(state, "exposure");
    int papers = display.tonemap == render::ToneMap::Papers ? 1 : 0;
    ImGui::RadioButton("film", &papers, 0);
    ImGui::SameLine();
    ImGui::RadioButton("1 - exp(-L)", &papers, 1);
    display.tonemap = papers == 1 ? render::ToneMap::Papers : render::ToneMap::Filmic;
}

}  // namespace

void draw_look_panel(Viewer& viewer, PanelState& state) {
    if (!ImGui::CollapsingHeader("Look", ImGuiTreeNodeFlags_DefaultOpen))
        return;
    const Look before = viewer.look;
    draw_cameras(viewer, state);
    draw_exposure(viewer, state);
    int shown = static_cast<int>(viewer.look.shown);
    ImGui::RadioButton("picture", &shown, static_cast<int>(Shown::Picture));
    mark(state, "picture");
    ImGui::SameLine();
    ImGui::RadioButton("lux", &shown, static_cast<int>(Shown::Lux));
    mark(state, "lux");
    ImGui::SameLine();
    ImGui::RadioButton("error", &shown, static_cast<int>(Shown::Error));
    mark(state, "error");
    viewer.look.shown = static_cast<Shown>(shown);
    ImGui::SameLine();
    ImGui::Checkbox("isolux", &viewer.look.has_isolux);
    mark(state, "isolux");
    if (viewer.look.shown == Shown::Lux) {
        ImGui::InputDouble("least lx", &viewer.look.least_lux, 0, 0, "%g");
        ImGui::InputDouble("most lx", &viewer.look.most_lux, 0, 0, "%g");
        viewer.look.least_lux = std::clamp(viewer.look.least_lux, 1e-6, 1e9);
        viewer.look.most_lux =
            std::clamp(viewer.look.most_lux, 1.001 * viewer.look.least_lux, 1e12);
    }
    bool is_measuring = viewer.tool == Tool::Measure;
    if (ImGui::Checkbox("measure a region: drag", &is_measuring))
        viewer.tool = is_measuring ? Tool::Measure : Tool::Select;
    mark(state, "measure");
    if (const auto found = region_statistics(viewer))
        ImGui::Text("%zu px: min %.4g, max %.4g, mean %.4g lx\nuniformity min/mean %.3f",
                    found->pixels, found->least, found->largest, found->mean, found->uniformity);
    viewer.is_stale = viewer.is_stale || !(viewer.look == before);
}

void draw_compare_panel(Viewer& viewer, PanelState& state) {
    if (!ImGui::CollapsingHeader("Compare"))
        return;
    if (ImGui::Button("keep this state"))
        keep_state(viewer);
    mark(state, "keep");
    ImGui::InputTextWithHint("##reference", "picture, .exr", &state.reference_path);
    mark(state, "reference path");
    ImGui::SameLine();
    if (ImGui::Button("compare") && state.commands.compare_with)
        state.commands.compare_with(state.reference_path);
    mark(state, "compare");
    if (!viewer.kept)
        return;
    if (ImGui::Button("forget it")) {
        viewer.kept.reset();
        viewer.is_stale = true;
        return;
    }
    auto split = static_cast<float>(viewer.split);
    if (ImGui::SliderFloat("split", &split, 0.0F, 1.0F, "%.2f")) {
        viewer.split = static_cast<double>(split);
        viewer.is_stale = true;
    }
    mark(state, "split");
    if (ImGui::Checkbox("error map", &viewer.shows_map))
        viewer.is_stale = true;
    if (viewer.difference)
        ImGui::Text("left of the split: %s\nLab %.4g, relative RMS %.3g %%, 95 %%: %.3g %%",
                    viewer.kept->name.c_str(), viewer.difference->lab,
                    100.0 * viewer.difference->rms_rel, 100.0 * viewer.difference->p95_rel);
    else
        ImGui::TextDisabled("%s: %d x %d px; no numbers\nuntil both are of one size",
                            viewer.kept->name.c_str(), viewer.kept->mixed.size_px.x,
                            viewer.kept->mixed.size_px.y);
}

}  // namespace nearfield::viewer
