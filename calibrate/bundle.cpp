// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bundle.h"

#include "calibrate/bundle_residuals.h"

#include <Eigen/Geometry>

#include <cmath>
#include <limits>

namespace nearfield::calibrate {
namespace {

constexpr double kStep_m = 1e-6;  // of central differences where a picture position is smooth

std::optional<glm::dvec2> seen_camera_px(const Bundle& bundle, const Vector3<double>& p_camera) {
    glm::dvec2 at_px(0.0);
    if (!seen_px(bundle.model, bundle.lens.data(), p_camera, &at_px.x))
        return std::nullopt;
    return at_px;
}

Vector3<double> corner_camera(const Bundle& bundle, std::size_t view, const Corner& corner) {
    const Vector3<double> p_board = bent_point(board_point(bundle, corner), bundle.bend_m.data());
    const BoardPose& board = bundle.boards[view];
    if (board.plane == capture::TargetPlane::Free)
        return free_point_camera(board.numbers.data(), p_board);
    const PlaneMove& plane = board.plane == capture::TargetPlane::Screen ? bundle.s : bundle.u;
    return plane_point_camera(plane.camera_from_anchor, plane.numbers.data(),
                              placed_point_plane(board.numbers.data(), p_board));
}

Vector3<double> center_camera(const Bundle& bundle, glm::dvec2 steps, glm::dvec2 moved_m) {
    Vector3<double> p =
        grid_point_plane(bundle.stage.numbers.data(), bundle.stage.handedness, steps);
    p.x() += moved_m.x;
    p.y() += moved_m.y;
    return plane_point_camera(bundle.u.camera_from_anchor, bundle.u.numbers.data(), p);
}

// A frame from three of its points in the camera's frame.
template <typename PointCamera>
Rigid frame_from(const PointCamera& point_camera) {
    const Vector3<double> origin = point_camera(0.0, 0.0);
    const Vector3<double> x = (point_camera(1.0, 0.0) - origin).normalized();
    const Vector3<double> z = x.cross(point_camera(0.0, 1.0) - origin).normalized();
    const Vector3<double> y = z.cross(x);
    return {glm::dmat3(glm_from(x), glm_from(y), glm_from(z)), glm_from(origin)};
}

}  // namespace

std::optional<glm::dvec2> corner_residual_px(const Bundle& bundle,
                                             std::size_t view,
                                             const Corner& corner) {
    const auto seen = seen_camera_px(bundle, corner_camera(bundle, view, corner));
    return seen ? std::optional(corner.at_px - *seen) : std::nullopt;
}

std::optional<glm::dvec2> filter_residual_px(const Bundle& bundle, const FilterView& filter) {
    const auto seen = seen_camera_px(
        bundle,
        center_camera(bundle, glm::dvec2(filter.position) - bundle.stage.middle, glm::dvec2(0.0)));
    return seen ? std::optional(filter.center_px - *seen) : std::nullopt;
}

glm::dmat2 filter_px_by_m(const Bundle& bundle, glm::ivec2 position) {
    const glm::dvec2 steps = glm::dvec2(position) - bundle.stage.middle;
    const auto slope = [&](glm::dvec2 along) {
        const auto ahead = seen_camera_px(bundle, center_camera(bundle, steps, along * kStep_m));
        const auto behind = seen_camera_px(bundle, center_camera(bundle, steps, along * -kStep_m));
        return ahead && behind ? (*ahead - *behind) / (2.0 * kStep_m) : glm::dvec2(0.0);
    };
    return {slope({1.0, 0.0}), slope({0.0, 1.0})};
}

glm::dvec3 filter_center_camera(const Bundle& bundle, glm::ivec2 position) {
    return glm_from(
        center_camera(bundle, glm::dvec2(position) - bundle.stage.middle, glm::dvec2(0.0)));
}

Rigid camera_from_board(const Bundle& bundle, std::size_t view) {
    Bundle flat;
    flat.s = bundle.s;
    flat.u = bundle.u;
    flat.boards = {bundle.boards[view]};
    return frame_from([&](double x, double y) {
        return corner_camera(flat, 0, {0, {x, y}, glm::dvec2(0.0)});
    });
}

Rigid camera_from_plane(const PlaneMove& plane) {
    return frame_from([&](double x, double y) {
        return plane_point_camera(plane.camera_from_anchor, plane.numbers.data(),
                                  Vector3<double>(x, y, 0.0));
    });
}

rig::Lens lens_of(const Bundle& bundle) {
    rig::Lens lens;
    lens.model = bundle.model;
    lens.size_px = bundle.size_px;
    lens.fx_px = bundle.lens[0];
    lens.fy_px = bundle.lens[1];
    lens.cx_px = bundle.lens[2];
    lens.cy_px = bundle.lens[3];
    lens.distortion.assign(bundle.lens.begin() + 4, bundle.lens.end());
    return lens;
}

}  // namespace nearfield::calibrate
