// SPDX-License-Identifier: Apache-2.0
#include "app/calibration_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace nearfield::app {
namespace {

using calibrate::Geometry;
using report::Section;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

// Residual vectors of all views, outliers in red. They are enlarged so that one sigma is a visible
// share of the picture.
report::VectorMap residual_map(const Geometry& geometry) {
    constexpr double kSigmaOnPicture = 0.012;  // of the picture's width
    report::VectorMap map;
    const glm::dvec2 size_px(geometry.lens.size_px);
    map.enlargement =
        std::max(1.0, std::round(kSigmaOnPicture * size_px.x / geometry.corner_sigma_px));
    map.title = fmt::format("Residuals of corners, {:g} times enlarged", map.enlargement);
    map.x_label = "x, px";
    map.y_label = "y, px";
    map.upper = size_px;
    map.flip_y = true;
    map.groups = {{"corners", "#1040a0", {}, {}}, {"outliers, left out", "#d02020", {}, {}}};
    for (const calibrate::ViewResult& view : geometry.views)
        for (const calibrate::CornerResidual& corner : view.corners) {
            report::VectorMap::Vectors& group = map.groups[corner.is_outlier ? 1 : 0];
            group.at.push_back(corner.at_px);
            group.vector.push_back(corner.residual_px);
        }
    if (map.groups[1].at.empty())
        map.groups.pop_back();
    return map;
}

report::HeatMap heat_map(const calibrate::PictureMap& map,
                         glm::ivec2 size_px,
                         const std::string& title,
                         const std::string& value_label) {
    report::HeatMap heat;
    heat.title = title;
    heat.x_label = "x, px";
    heat.y_label = "y, px";
    heat.value_label = value_label;
    heat.upper = glm::dvec2(size_px);
    heat.flip_y = true;
    heat.size = map.count;
    heat.values = map.value_px;
    for (const double value : map.value_px)
        if (std::isfinite(value))
            heat.high = std::max(heat.high, value);
    heat.picture_px = {760, 560};
    return heat;
}

std::string plane_word(capture::TargetPlane plane) {
    switch (plane) {
        case capture::TargetPlane::Screen:
            return "on S";
        case capture::TargetPlane::Filter:
            return "on U";
        case capture::TargetPlane::Free:
            break;
    }
    return "by hand";
}

report::Table view_table(const Geometry& geometry) {
    report::Table table{
        "Views of the target", {"view", "board", "corners", "RMS, px", "left out"}, {}};
    for (const calibrate::ViewResult& view : geometry.views) {
        const auto outliers = std::count_if(view.corners.begin(), view.corners.end(),
                                            [](const auto& corner) { return corner.is_outlier; });
        table.rows.push_back({view.name, plane_word(view.plane),
                              fmt::format("{}", view.corners.size()),
                              fmt::format("{:.3f}", view.rms_px), fmt::format("{}", outliers)});
    }
    for (const calibrate::UnusedView& view : geometry.unused)
        table.rows.push_back({view.name, "not used", view.why, "", ""});
    return table;
}

Section camera_section(const Geometry& geometry) {
    Section section{"The camera", {}, {}, {}, {}};
    std::size_t corners = 0;
    for (const calibrate::ViewResult& view : geometry.views)
        corners += view.corners.size();
    section.paragraphs.push_back(
        fmt::format("{} corners in {} views, RMS of the residuals' length {:.3f} px; noise of a "
                    "corner along an "
                    "axis {:.3f} px. {} corners further off than the limit were left out.",
                    corners, geometry.views.size(), geometry.rms_px, geometry.corner_sigma_px,
                    geometry.outliers.size()));
    add_drawing(
        section,
        draw(residual_map(geometry),
             "Observed minus predicted. Arrows without order are noise; arrows that agree "
             "with their neighbors are a lens or a board that the model does not describe."));
    section.tables.push_back(view_table(geometry));
    if (!geometry.outliers.empty()) {
        report::Table table{"Corners left out", {"view", "corner", "residual, px"}, {}};
        for (const calibrate::Outlier& outlier : geometry.outliers)
            table.rows.push_back({outlier.name, fmt::format("{}", outlier.corner),
                                  fmt::format("{:.2f}", outlier.residual_px)});
        section.tables.push_back(std::move(table));
    }
    return section;
}

Section knowledge_section(const Geometry& geometry) {
    Section section{"How well the camera is known", {}, {}, {}, {}};
    const glm::ivec2 size_px = geometry.lens.size_px;
    add_drawing(section,
                draw(heat_map(geometry.uncertainty, size_px,
                              "Sigma of where a far point is seen, along an axis", "px"),
                     "Predicted from the corners' noise; what a turn of the camera explains is "
                     "taken out."));
    if (geometry.halves) {
        section.paragraphs.push_back(fmt::format(
            "Two halves of the views, calibrated by themselves, see far points {:.3f} px (RMS) "
            "apart; "
            "their sigmas predict {:.3f} px.{}",
            geometry.halves->difference_rms_px, geometry.halves->predicted_rms_px,
            geometry.halves->difference_rms_px > 2 * geometry.halves->predicted_rms_px
                ? " That is more than noise: the lens model does not fit, or the board is not what "
                  "was said."
                : ""));
        add_drawing(section,
                    draw(heat_map(geometry.halves->difference, size_px,
                                  "How far two halves of the views disagree", "px"),
                         "Distance between two lenses' far points, the best turn taken out."));
    }
    if (geometry.held_out)
        section.paragraphs.push_back(fmt::format(
            "Views that the lens was not fitted to: RMS {:.3f} px, against {:.3f} px of those that "
            "it was ({} folds).",
            geometry.held_out->rms_px, geometry.held_out->fitted_rms_px, geometry.held_out->folds));
    if (geometry.bend) {
        const glm::dvec3 bend_um = 1e6 * geometry.bend->bend_m;
        const glm::dvec3 sigma_um = 1e6 * geometry.bend->sigma_m;
        section.paragraphs.push_back(fmt::format(
            "The board's shape (height at the middle of its edges): {:.0f} +- {:.0f} um across, "
            "{:.0f} +- {:.0f} um along a diagonal, {:.0f} +- {:.0f} um down; {:.1f} sigma from "
            "flat.{}",
            bend_um.x, sigma_um.x, bend_um.y, sigma_um.y, bend_um.z, sigma_um.z,
            std::max(0.0, geometry.bend->significance_sigma),
            geometry.bend->significance_sigma > 4
                ? " The board is bent: calibrate with --bent-board, or use a stiffer one."
                : ""));
    }
    return section;
}

using Line = report::Wireframe::Line;

// A rectangle in a frame, closed.
Line rectangle(const Rigid& slab_from_frame,
               glm::dvec2 lower_m,
               glm::dvec2 upper_m,
               const std::string& name,
               const std::string& color) {
    Line line{name, color, {}};
    const glm::dvec2 corners[] = {
        lower_m, {upper_m.x, lower_m.y}, upper_m, {lower_m.x, upper_m.y}, lower_m};
    for (const glm::dvec2 corner : corners)
        line.points.push_back(slab_from_frame.rotation * glm::dvec3(corner, 0.0) +
                              slab_from_frame.translation_m);
    return line;
}

Rigid inverse(const Rigid& a_from_b) {
    const glm::dmat3 rotation = glm::transpose(a_from_b.rotation);
    return {rotation, -(rotation * a_from_b.translation_m)};
}

Rigid chained(const Rigid& a_from_b, const Rigid& b_from_c) {
    return {a_from_b.rotation * b_from_c.rotation,
            a_from_b.rotation * b_from_c.translation_m + a_from_b.translation_m};
}

void add_boards(const Geometry& geometry, const Rigid& slab_from_camera, std::vector<Line>& lines) {
    std::array<bool, 3> is_named{};
    for (const calibrate::ViewResult& view : geometry.views) {
        glm::dvec2 lower_m(1e300), upper_m(-1e300);
        for (const calibrate::CornerResidual& corner : view.corners) {
            lower_m = glm::min(lower_m, corner.board_m);
            upper_m = glm::max(upper_m, corner.board_m);
        }
        const auto kind = static_cast<std::size_t>(view.plane);
        const std::array<const char*, 3> colors = {"#208020", "#c03020", "#a0a0c0"};
        const std::array<const char*, 3> names = {"board on S", "board on U", "board by hand"};
        lines.push_back(rectangle(chained(slab_from_camera, view.camera_from_board), lower_m,
                                  upper_m, is_named[kind] ? "" : names[kind], colors[kind]));
        is_named[kind] = true;
    }
}

void add_camera(const Geometry& geometry, const Rigid& slab_from_camera, std::vector<Line>& lines) {
    const glm::dvec2 size_px(geometry.lens.size_px);
    const glm::dvec3 center_m = slab_from_camera.translation_m;
    const double reach_m = 0.25 * glm::length(center_m);
    Line picture{"camera", "#404040", {}};
    const glm::dvec2 corners_px[] = {{0, 0}, {size_px.x, 0}, size_px, {0, size_px.y}, {0, 0}};
    for (const glm::dvec2 corner_px : corners_px)
        if (const auto ray = rig::ray_camera(geometry.lens, corner_px)) {
            const glm::dvec3 end_m = center_m + slab_from_camera.rotation * (reach_m * *ray);
            picture.points.push_back(end_m);
            lines.push_back({"", "#404040", {center_m, end_m}});
        }
    lines.push_back(std::move(picture));
}

report::Wireframe scene_of(const Geometry& geometry, const calibrate::PlanesResult& result) {
    const Rigid slab_from_camera = inverse(result.planes.camera_from_slab);
    report::Wireframe scene{"Everything in the slab's frame", "x, m", "y, m", "z, m", 30, 65, {}};
    add_boards(geometry, slab_from_camera, scene.lines);
    const auto [columns, rows] = std::pair(result.planes.grid.x, result.planes.grid.y);
    for (int row = 0; row < rows; ++row) {
        Line line{row == 0 ? "filter positions on U" : "", "#e08000", {}};
        for (int column = 0; column < columns; ++column)
            line.points.push_back(
                result.planes.position_m[static_cast<std::size_t>(row * columns + column)]);
        scene.lines.push_back(std::move(line));
    }
    add_camera(geometry, slab_from_camera, scene.lines);
    return scene;
}

report::VectorMap step_map(const calibrate::PlanesResult& result) {
    report::VectorMap map;
    const rig::Planes& planes = result.planes;
    glm::dvec2 lower_m(1e300), upper_m(-1e300);
    for (const glm::dvec3& position_m : planes.position_m) {
        lower_m = glm::min(lower_m, glm::dvec2(position_m));
        upper_m = glm::max(upper_m, glm::dvec2(position_m));
    }
    map.lower = 1e3 * (lower_m - planes.pitch_m);
    map.upper = 1e3 * (upper_m + planes.pitch_m);
    constexpr double kMostOnGrid = 0.7;  // of a pitch
    double most_m = 1e-9;
    report::VectorMap::Vectors steps{"filter seen here", "#c03020", {}, {}};
    for (const calibrate::FilterResult& filter : result.filters) {
        most_m = std::max(most_m, glm::length(filter.step_error_m));
        const int index = filter.position.y * planes.grid.x + filter.position.x;
        steps.at.push_back(1e3 * glm::dvec2(planes.position_m[static_cast<std::size_t>(index)]));
        steps.vector.push_back(1e3 * filter.step_error_m);
    }
    map.enlargement =
        std::round(kMostOnGrid * std::min(planes.pitch_m.x, planes.pitch_m.y) / most_m);
    map.title = fmt::format("The stage's errors, {:g} times enlarged", map.enlargement);
    map.x_label = "x on U, mm";
    map.y_label = "y on U, mm";
    map.groups = {std::move(steps)};
    return map;
}

Section planes_section(const Geometry& geometry, const calibrate::PlanesResult& result) {
    const rig::Planes& planes = result.planes;
    Section section{"The planes S and U", {}, {}, {}, {}};
    const glm::dvec2 tilt_deg = kDegPerRad * planes.u_tilt_rad;
    section.paragraphs.push_back(fmt::format(
        "U lies {:.3f} mm behind S and is turned against it by {:.3f} and {:.3f} degrees about x "
        "and "
        "y. The stage steps {:.4f} and {:.4f} mm; its y axis leans by {:.3f} degrees; the filter "
        "is "
        "turned by {:.3f} degrees.",
        1e3 * planes.delta_m, tilt_deg.x, tilt_deg.y, 1e3 * planes.pitch_m.x,
        1e3 * planes.pitch_m.y, kDegPerRad * planes.skew_rad, kDegPerRad * planes.filter_turn_rad));
    section.paragraphs.push_back(fmt::format(
        "Taking the planes for parallel moves a ray on U by at most {:.3g} mm and turns it by at "
        "most "
        "{:.3g} degrees. Taking the positions for a regular grid is wrong by up to {:.3g} mm.",
        1e3 * result.parallel.position_m, kDegPerRad * result.parallel.direction_rad,
        1e3 * result.parallel.center_most_m));
    section.paragraphs.push_back(
        result.is_step_sigma_known
            ? fmt::format("The stage misses a position by {:.1f} um (one sigma, along an axis).",
                          1e6 * result.step_sigma_m)
            : std::string(
                  "Too few filter positions were seen to tell how well the stage keeps them."));
    add_drawing(
        section,
        draw(scene_of(geometry, result),
             "Boards as they were seen, the planes, the camera and a quarter of its view."));
    add_drawing(section,
                draw(step_map(result), "Where the filter was seen against a regular grid."));
    return section;
}

}  // namespace

std::vector<Section> geometry_sections(const Geometry& geometry) {
    std::vector<Section> sections = {camera_section(geometry), knowledge_section(geometry)};
    if (geometry.planes)
        sections.push_back(planes_section(geometry, *geometry.planes));
    sections.push_back(
        {"Parameters of the geometry", {}, {}, {parameter_table(geometry.parameters)}, {}});
    return sections;
}

}  // namespace nearfield::app
