// SPDX-License-Identifier: Apache-2.0
/// How a camera maps points in front of it to its picture.
///
/// Camera frame: looks along +z, x right, y down in the picture. Picture positions are in pixels;
/// (0, 0) is the picture's upper left corner, the first pixel's center (0.5, 0.5), and so are cx
/// and cy meant. OpenCV counts from the first pixel's center instead: its cx is ours minus 0.5.
#pragma once

#include <glm/glm.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nearfield::rig {

/// Brown5, Brown8: pinhole with OpenCV's k1 k2 p1 p2 k3 [k4 k5 k6]; Brown8's radial factor is the
/// ratio (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6). Fisheye: r = theta (1 +
/// k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), theta the angle to the axis (Kannala and
/// Brandt 2006).
enum class LensModel { Brown5, Brown8, Fisheye };

struct Lens {
    LensModel model = LensModel::Brown5;
    glm::ivec2 size_px{0};  // of the picture
    double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
    std::vector<double> distortion;  // 5, 8 or 4 numbers, in the order above
};

/// Count of distortion's numbers.
int distortion_count(LensModel model);

/// Picture position of a point in the camera's frame; none at or behind its center (a fisheye sees
/// up to 90 degrees here too: nothing we measure lies further out).
std::optional<glm::dvec2> project_px(const Lens& lens, glm::dvec3 point_camera);

/// Direction (x, y, 1) in the camera's frame that is seen at a picture position: the inverse of
/// project_px, to 1e-10 px. None where the distortion folds back before that position is reached.
std::optional<glm::dvec3> ray_camera(const Lens& lens, glm::dvec2 position_px);

}  // namespace nearfield::rig
