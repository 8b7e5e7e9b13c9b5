// SPDX-License-Identifier: Apache-2.0
/// Residuals of the bundle adjustment, for numbers of any type.
#pragma once

#include "calibrate/bundle.h"
#include "formats/rig/lens_model.h"

#include <Eigen/Core>
#include <ceres/rotation.h>

namespace nearfield::calibrate {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

constexpr int lens_numbers(rig::LensModel model) {
    return model == rig::LensModel::Brown5 ? 9 : model == rig::LensModel::Brown8 ? 12 : 8;
}

inline Eigen::Matrix3d eigen_from(const glm::dmat3& m) {
    return Eigen::Map<const Eigen::Matrix3d>(&m[0][0]);
}
inline Eigen::Vector3d eigen_from(glm::dvec3 v) {
    return {v.x, v.y, v.z};
}
inline glm::dvec3 glm_from(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

/// A board's corner with the board's bend: z = a x^2 + b x y + c y^2.
struct BoardPoint {
    glm::dvec2 board_m{0.0};
    glm::dvec2 relative{0.0};  // to the board's middle, in its half sizes
};

inline BoardPoint board_point(const Bundle& bundle, const Corner& corner) {
    return {corner.board_m, (corner.board_m - bundle.board_middle_m) / bundle.board_half_m};
}

template <typename T>
Vector3<T> bent_point(const BoardPoint& point, const T* bend_m) {
    const double x = point.relative.x, y = point.relative.y;
    return {T(point.board_m.x), T(point.board_m.y),
            bend_m[0] * (x * x) + bend_m[1] * (x * y) + bend_m[2] * (y * y)};
}

template <typename T>
Vector3<T> free_point_camera(const T* pose, const Vector3<T>& p_board) {
    Vector3<T> p;
    ceres::AngleAxisRotatePoint(pose, p_board.data(), p.data());
    return {p[0] + pose[3], p[1] + pose[4], p[2] + pose[5]};
}

/// A point of a plane's frame in the camera's.
template <typename T>
Vector3<T> plane_point_camera(const Rigid& camera_from_anchor,
                              const T* move,
                              const Vector3<T>& p_plane) {
    const T turn[3] = {move[0], move[1], T(0.0)};
    Vector3<T> p;
    ceres::AngleAxisRotatePoint(turn, p_plane.data(), p.data());
    p[2] += move[2];
    return eigen_from(camera_from_anchor.rotation).cast<T>() * p +
           eigen_from(camera_from_anchor.translation_m).cast<T>();
}

/// A point of a board that lies on a plane, in the plane's frame.
template <typename T>
Vector3<T> placed_point_plane(const T* place, const Vector3<T>& p_board) {
    using std::cos;
    using std::sin;
    const T c = cos(place[2]), s = sin(place[2]);
    return {place[0] + c * p_board[0] - s * p_board[1], place[1] + s * p_board[0] + c * p_board[1],
            p_board[2]};
}

/// A center of the stage's grid, `steps` from its middle, in U's frame.
template <typename T>
Vector3<T> grid_point_plane(const T* stage, double handedness, glm::dvec2 steps) {
    using std::cos;
    using std::sin;
    const T along_x = stage[3] * steps.x, along_y = stage[4] * steps.y;
    const T x = along_x + along_y * sin(stage[5]);
    const T y = along_y * cos(stage[5]) * handedness;
    const T c = cos(stage[2]), s = sin(stage[2]);
    return {stage[0] + c * x - s * y, stage[1] + s * x + c * y, T(0.0)};
}

/// Picture position; false behind the camera.
template <typename T>
bool seen_px(rig::LensModel model, const T* lens, const Vector3<T>& p_camera, T* at_px) {
    if (!(p_camera[2] > T(0.0)))
        return false;
    const rig::Point<T> p =
        rig::position_px(model, lens, T(p_camera[0] / p_camera[2]), T(p_camera[1] / p_camera[2]));
    at_px[0] = p.x;
    at_px[1] = p.y;
    return true;
}

/// Observed minus predicted in units of sigma: a corner of a board anywhere.
template <rig::LensModel kModel>
struct FreeCornerResidual {
    BoardPoint point;
    glm::dvec2 at_px;
    double sigma_px;

    template <typename T>
    bool operator()(const T* lens, const T* bend_m, const T* pose, T* residual) const {
        if (!seen_px(kModel, lens, free_point_camera(pose, bent_point(point, bend_m)), residual))
            return false;
        residual[0] = (at_px.x - residual[0]) / sigma_px;
        residual[1] = (at_px.y - residual[1]) / sigma_px;
        return true;
    }
};

/// The same of a board on a plane.
template <rig::LensModel kModel>
struct PlacedCornerResidual {
    BoardPoint point;
    glm::dvec2 at_px;
    double sigma_px;
    Rigid camera_from_anchor;

    template <typename T>
    bool operator()(
        const T* lens, const T* bend_m, const T* move, const T* place, T* residual) const {
        const Vector3<T> p_plane = placed_point_plane(place, bent_point(point, bend_m));
        if (!seen_px(kModel, lens, plane_point_camera(camera_from_anchor, move, p_plane), residual))
            return false;
        residual[0] = (at_px.x - residual[0]) / sigma_px;
        residual[1] = (at_px.y - residual[1]) / sigma_px;
        return true;
    }
};

/// A filter's center against the stage's regular grid, whitened.
template <rig::LensModel kModel>
struct FilterResidual {
    glm::dvec2 steps;
    double handedness;
    glm::dvec2 at_px;
    glm::dmat2 whitening;
    Rigid camera_from_anchor;

    template <typename T>
    bool operator()(const T* lens, const T* move, const T* stage, T* residual) const {
        const Vector3<T> p_plane = grid_point_plane(stage, handedness, steps);
        T seen[2];
        if (!seen_px(kModel, lens, plane_point_camera(camera_from_anchor, move, p_plane), seen))
            return false;
        const T x = at_px.x - seen[0], y = at_px.y - seen[1];
        residual[0] = whitening[0][0] * x + whitening[1][0] * y;
        residual[1] = whitening[0][1] * x + whitening[1][1] * y;
        return true;
    }
};

}  // namespace nearfield::calibrate
