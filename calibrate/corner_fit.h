// SPDX-License-Identifier: Apache-2.0
/// Refines a corner of a board by fitting what a blurred corner looks like.
#pragma once

#include <glm/glm.hpp>
#include <opencv2/core.hpp>

#include <optional>

namespace nearfield::calibrate {

/// Where a corner is looked for: near the two edges that cross there, off the markers.
struct CornerWindow {
    glm::dvec2 start_px{0.0};
    glm::dmat2 px_from_squares{1.0};  // the picture of the board around it, edges along x and y
    double clear_squares = 0.5;       // between an edge and the markers beside it
};

/// The crossing of two edges, each an error function of its own direction and of one blur, under
/// light that may slope:
///
///     I(x) = (1 + slope . d)(middle + contrast erf(n1 . d / sqrt2 s) erf(n2 . d / sqrt2 s)),   d =
///     x - corner
///
/// fitted to the pixels beside the edges by least squares; pixels that stick out are left out.
/// Unlike a corner from gradients (Forstner) it knows that a pixel is an area, so that it has no
/// bias that depends on where in its pixel the corner lies: docs/calibration_geometry.md.
///
/// In      values: float; positions in pixels from the center of the first (OpenCV's).
/// Out     nothing where the pixels are too few or do not look like a corner.
/// Cost    0.1 to 0.3 ms.
std::optional<glm::dvec2> fit_corner(const cv::Mat& values, const CornerWindow& window);

}  // namespace nearfield::calibrate
