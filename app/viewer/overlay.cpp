// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/panels.h"

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <imgui.h>

#include <array>
#include <cmath>

namespace nearfield::viewer {
namespace {

constexpr std::array<ImU32, 3> kAxisColors = {
    IM_COL32(235, 80, 70, 255), IM_COL32(90, 205, 80, 255), IM_COL32(80, 130, 245, 255)};
constexpr ImU32 kHot = IM_COL32(255, 230, 90, 255), kPale = IM_COL32(255, 255, 255, 200);

/// The window's places of the world's points.
struct Canvas {
    const Camera& camera;
    glm::ivec2 size;
    ImDrawList* list;

    void line(glm::dvec3 from_world_m, glm::dvec3 to_world_m, ImU32 color, float width) const {
        const auto a = projected(camera, size, from_world_m),
                   b = projected(camera, size, to_world_m);
        if (a && b)
            list->AddLine(ImVec2(static_cast<float>(a->x), static_cast<float>(a->y)),
                          ImVec2(static_cast<float>(b->x), static_cast<float>(b->y)), color, width);
    }
};

ImU32 color_of(const Viewer& viewer, Handle handle) {
    const bool is_hot = viewer.drag ? viewer.drag->handle == handle : viewer.hot == handle;
    return is_hot ? kHot : kAxisColors[static_cast<std::size_t>(handle.axis)];
}

void draw_gizmo(const Viewer& viewer, const EditedLamp& lamp, const Canvas& canvas) {
    const Gizmo gizmo =
        gizmo_of(lamp.luminaire.world_from_luminaire, canvas.camera, viewer.has_lamps_axes);
    for (int axis = 0; axis < 3; ++axis) {
        const auto u = static_cast<std::size_t>((axis + 1) % 3),
                   v = static_cast<std::size_t>((axis + 2) % 3);
        canvas.line(gizmo.at_world_m,
                    gizmo.at_world_m + gizmo.size_m * gizmo.axes[static_cast<std::size_t>(axis)],
                    color_of(viewer, {HandleKind::Move, axis}), 3.0F);
        constexpr int kPieces = 48;
        const auto on_ring = [&](int k) {
            const double angle = glm::two_pi<double>() * k / kPieces;
            return gizmo.at_world_m +
                   kRingOfSize * gizmo.size_m *
                       (std::cos(angle) * gizmo.axes[u] + std::sin(angle) * gizmo.axes[v]);
        };
        for (int k = 0; k < kPieces; ++k)
            canvas.line(on_ring(k), on_ring(k + 1), color_of(viewer, {HandleKind::Turn, axis}),
                        1.5F);
    }
}

/// The arrows' ends, for those that drive the window.
void mark_handles(const Viewer& viewer,
                  const EditedLamp& lamp,
                  const Canvas& canvas,
                  PanelState& state) {
    const Gizmo gizmo =
        gizmo_of(lamp.luminaire.world_from_luminaire, canvas.camera, viewer.has_lamps_axes);
    constexpr std::array<const char*, 3> kNames = {"handle x", "handle y", "handle z"};
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (const auto at = projected(canvas.camera, canvas.size,
                                      gizmo.at_world_m + 0.9 * gizmo.size_m * gizmo.axes[axis]))
            state.places[kNames[axis]] = glm::vec4(glm::dvec4(*at, *at));
}

/// Where it is, and a stroke along its light.
void draw_lamp(const EditedLamp& lamp, bool is_selected, const Canvas& canvas) {
    const glm::dmat4& pose = lamp.luminaire.world_from_luminaire;
    const glm::dvec3 at_world_m(pose[3]);
    const auto at = projected(canvas.camera, canvas.size, at_world_m);
    if (!at)
        return;
    const ImVec2 center(static_cast<float>(at->x), static_cast<float>(at->y));
    const ImU32 color = is_selected ? kHot : kPale;
    canvas.list->AddCircle(center, 7.0F, color, 0, lamp.luminaire.on ? 2.5F : 1.0F);
    canvas.line(at_world_m, at_world_m + 0.4 * glm::normalize(glm::dvec3(pose[2])), color, 1.5F);
    canvas.list->AddText(ImVec2(center.x + 10.0F, center.y - 6.0F), color,
                         lamp.luminaire.name.c_str());
}

void draw_region(const Viewer& viewer, glm::vec2 window, ImDrawList* list) {
    if (!viewer.region)
        return;
    const glm::vec2 a = glm::vec2(viewer.region->first) * window,
                    b = glm::vec2(viewer.region->second) * window;
    list->AddRect(ImVec2(std::min(a.x, b.x), std::min(a.y, b.y)),
                  ImVec2(std::max(a.x, b.x), std::max(a.y, b.y)), kPale);
}

/// The false colors' scale, with its numbers: powers of ten of lux.
void draw_scale(const Viewer& viewer, glm::vec2 window, ImDrawList* list) {
    if (viewer.look.shown != Shown::Lux)
        return;
    const double least = viewer.look.least_lux, most = viewer.look.most_lux;
    const float left = 0.32F * window.x, width = 0.36F * window.x, top = window.y - 60.0F;
    constexpr int kSteps = 128;
    for (int k = 0; k < kSteps; ++k) {
        const glm::u8vec3 color = scale_color((k + 0.5) / kSteps);
        list->AddRectFilled(ImVec2(left + width * static_cast<float>(k) / kSteps, top),
                            ImVec2(left + width * static_cast<float>(k + 1) / kSteps, top + 14.0F),
                            IM_COL32(color.r, color.g, color.b, 255));
    }
    const auto label = [&](double lux) {
        const float x = left + width * static_cast<float>(scale_position(lux, least, most));
        list->AddLine(ImVec2(x, top), ImVec2(x, top + 18.0F), kPale);
        list->AddText(ImVec2(x - 10.0F, top + 18.0F), kPale, fmt::format("{:g}", lux).c_str());
    };
    for (double lux = std::pow(10.0, std::ceil(std::log10(least) - 1e-9)); lux <= 1.0001 * most;
         lux *= 10.0)
        label(lux);
    list->AddText(ImVec2(left + width + 12.0F, top), kPale, "lx");
}

}  // namespace

void draw_overlay(const Viewer& viewer, PanelState& state, glm::vec2 window) {
    if (!viewer.is_open)
        return;
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const Canvas canvas{viewer.view.camera, glm::ivec2(window), list};
    for (const EditedLamp& lamp : viewer.history.now.lamps)
        draw_lamp(lamp, viewer.selected == lamp.id, canvas);
    const EditedLamp* lamp =
        viewer.selected ? find_lamp(viewer.history.now, *viewer.selected) : nullptr;
    if (lamp != nullptr && viewer.shows_panels) {
        draw_gizmo(viewer, *lamp, canvas);
        mark_handles(viewer, *lamp, canvas, state);
    }
    draw_region(viewer, window, list);
    draw_scale(viewer, window, list);
}

}  // namespace nearfield::viewer
