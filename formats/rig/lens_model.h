// SPDX-License-Identifier: Apache-2.0
/// The lens' formulas, for numbers of any type: double, dual numbers, ceres::Jet.
///
/// A point of the camera's frame is seen along its tangents (x, y) = (X / Z, Y / Z); distortion
/// moves it to another place on the plane Z = 1, and focal lengths and center turn that into
/// pixels. Sources: Brown, "Decentering distortion of lenses", 1966; OpenCV's rational model;
/// Kannala and Brandt, "A generic camera model and calibration method", 2006.
#pragma once

#include "formats/rig/lens.h"

#include <cmath>

namespace nearfield::rig {

/// A point on the plane Z = 1, or in the picture.
template <typename T>
struct Point {
    T x, y;
};

/// The radial factor of Brown's models, of the square of the tangent's length; k1 k2 p1 p2 k3 [k4
/// k5 k6].
template <typename T>
T brown_radial(LensModel model, const T* k, const T& r2) {
    T above = T(1.0) + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    if (model == LensModel::Brown5)
        return above;
    return above / (T(1.0) + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
}

/// A fisheye's distorted length of an angle to the axis, k1 ... k4.
template <typename T>
T fisheye_length(const T* k, const T& theta) {
    const T t2 = theta * theta;
    return theta * (T(1.0) + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

/// Distorted tangents.
template <typename T>
Point<T> distorted(LensModel model, const T* k, const T& x, const T& y) {
    using std::atan;
    using std::sqrt;
    const T r2 = x * x + y * y;
    if (model == LensModel::Fisheye) {
        // Below, atan(r) / r = 1 - r^2 / 3 to the last digit, and the root has no derivative at 0.
        constexpr double kSmall = 1e-9;
        if (r2 < T(kSmall)) {
            const T factor = T(1.0) + r2 * (k[0] - T(1.0 / 3.0));
            return {x * factor, y * factor};
        }
        const T r = sqrt(r2);
        const T factor = fisheye_length(k, T(atan(r))) / r;
        return {x * factor, y * factor};
    }
    const T radial = brown_radial(model, k, r2);
    const T xy2 = T(2.0) * x * y;
    return {x * radial + k[2] * xy2 + k[3] * (r2 + T(2.0) * x * x),
            y * radial + k[2] * (r2 + T(2.0) * y * y) + k[3] * xy2};
}

/// Picture position in pixels of tangents; `lens` holds fx fy cx cy and the distortion's numbers.
template <typename T>
Point<T> position_px(LensModel model, const T* lens, const T& x, const T& y) {
    const Point<T> p = distorted(model, lens + 4, x, y);
    return {lens[0] * p.x + lens[2], lens[1] * p.y + lens[3]};
}

}  // namespace nearfield::rig
