// SPDX-License-Identifier: Apache-2.0
/// The slab's frame from the two planes and the stage's grid, for numbers of any type.
#pragma once

#include "calibrate/bundle_residuals.h"

#include <Eigen/Geometry>

namespace nearfield::calibrate {

/// What the slab follows from: moves of S and U and the grid, in this order.
constexpr int kSlabNumbers = 12;

/// Axes and origin in the camera's frame.
template <typename T>
struct SlabFrame {
    Vector3<T> x, y, z, origin;
    T delta_m;
    T tilt_x_rad, tilt_y_rad;  // U's normal is Ry(tilt_y) Rx(tilt_x) z
};

/// A direction of a plane's frame in the camera's.
template <typename T>
Vector3<T> plane_direction_camera(const Rigid& camera_from_anchor,
                                  const T* move,
                                  const Vector3<T>& d_plane) {
    const T turn[3] = {move[0], move[1], T(0.0)};
    Vector3<T> d;
    ceres::AngleAxisRotatePoint(turn, d_plane.data(), d.data());
    return eigen_from(camera_from_anchor.rotation).cast<T>() * d;
}

/// +z is where light goes: from U to S. S and U have normals away from the camera; the grid's
/// handedness tells whether that is the light's way too.
template <typename T>
SlabFrame<T> slab_frame(const Bundle& bundle, const T* numbers) {
    using std::asin;
    using std::atan2;
    using std::cos;
    using std::sin;
    const T *s = numbers, *u = numbers + 3, *stage = numbers + 6;
    const T sign(bundle.stage.handedness);
    const Rigid &s_anchor = bundle.s.camera_from_anchor, &u_anchor = bundle.u.camera_from_anchor;
    const Vector3<T> up(T(0.0), T(0.0), T(1.0));
    const Vector3<T> on_s = plane_point_camera(s_anchor, s, Vector3<T>(Vector3<T>::Zero()));
    const Vector3<T> middle =
        plane_point_camera(u_anchor, u, Vector3<T>(stage[0], stage[1], T(0.0)));
    const Vector3<T> along =
        plane_direction_camera(u_anchor, u, Vector3<T>(T(cos(stage[2])), T(sin(stage[2])), T(0.0)));

    SlabFrame<T> frame;
    frame.z = plane_direction_camera(s_anchor, s, up) * sign;
    frame.x = (along - frame.z * frame.z.dot(along)).normalized();
    frame.y = frame.z.cross(frame.x);
    frame.delta_m = frame.z.dot(on_s - middle);
    frame.origin = middle + frame.z * frame.delta_m;
    const Vector3<T> normal = plane_direction_camera(u_anchor, u, up) * sign;
    frame.tilt_x_rad = asin(-frame.y.dot(normal));
    frame.tilt_y_rad = atan2(frame.x.dot(normal), frame.z.dot(normal));
    return frame;
}

/// A point of U's frame in the slab's.
template <typename T>
Vector3<T> u_point_slab(const Bundle& bundle,
                        const SlabFrame<T>& frame,
                        const T* numbers,
                        const Vector3<T>& p_u) {
    const Vector3<T> p =
        plane_point_camera(bundle.u.camera_from_anchor, numbers + 3, p_u) - frame.origin;
    return {frame.x.dot(p), frame.y.dot(p), frame.z.dot(p)};
}

}  // namespace nearfield::calibrate
