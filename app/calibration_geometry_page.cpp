// SPDX-License-Identifier: Apache-2.0
#include "app/calibration_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::app {
namespace {

using calibrate::Geometry;
using report::Section;

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
