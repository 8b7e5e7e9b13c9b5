// SPDX-License-Identifier: Apache-2.0
/// Quadrature over a lamp's lens: Gauss nodes on the pieces into which facet edges divide it.
#pragma once

#include <glm/glm.hpp>

#include <vector>

namespace nearfield::sample_data {

/// Where a lamp shines from: a rectangle or an ellipse in the plane U, centered on the axis.
struct Aperture {
    glm::dvec2 half_m{0.0};
    bool is_ellipse = false;
    /// Lines x = ... and y = ... across which radiance may jump (facet edges), in any order.
    std::vector<double> breaks_x_m, breaks_y_m;
};

/// One weighted abscissa.
struct Node {
    double at_m = 0, weight_m = 0;
};

/// Nodes of one line y = const across the aperture. The integral of f is
/// sum over rows of y.weight_m * sum over x of weight_m * f(x.at_m, y.at_m).
struct ApertureRow {
    Node y;
    std::vector<Node> x;
};

/// Composite three-point Gauss nodes, exact for piecewise quintic integrands, neighbors at most
/// about spacing_m apart. On an ellipse y runs over an angle, so that its round ends cost no
/// accuracy.
std::vector<ApertureRow> aperture_rows(const Aperture& aperture, glm::dvec2 spacing_m);

/// Gauss nodes (2 or 3 `points` a part) on every interval between neighboring breaks in [lower,
/// upper], each cut into equal parts until the nodes are at most about `spacing` apart.
std::vector<Node> gauss_nodes(
    double lower, double upper, std::vector<double> breaks, double spacing, int points = 3);

}  // namespace nearfield::sample_data
