// SPDX-License-Identifier: Apache-2.0
#include "app/calibration_page.h"
#include "formats/files/rigid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace nearfield::app {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

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
        line.points.push_back(apply(slab_from_frame, glm::dvec3(corner, 0.0)));
    return line;
}

void add_boards(const calibrate::Geometry& geometry,
                const Rigid& slab_from_camera,
                std::vector<Line>& lines) {
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
        lines.push_back(rectangle(slab_from_camera * view.camera_from_board, lower_m, upper_m,
                                  is_named[kind] ? "" : names[kind], colors[kind]));
        is_named[kind] = true;
    }
}

void add_camera(const calibrate::Geometry& geometry,
                const Rigid& slab_from_camera,
                std::vector<Line>& lines) {
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

report::Wireframe scene_of(const calibrate::Geometry& geometry,
                           const calibrate::PlanesResult& result) {
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

}  // namespace

report::Section planes_section(const calibrate::Geometry& geometry,
                               const calibrate::PlanesResult& result) {
    const rig::Planes& planes = result.planes;
    report::Section section{"The planes S and U", {}, {}, {}, {}};
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

}  // namespace nearfield::app
