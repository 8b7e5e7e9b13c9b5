// SPDX-License-Identifier: Apache-2.0
#include "sample_data/aperture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace nearfield::sample_data {
namespace {

// Gauss-Legendre on [-1, 1], two and three points.
constexpr std::array<Node, 2> kTwo = {{{-0.5773502691896258, 1.0}, {0.5773502691896258, 1.0}}};
constexpr std::array<Node, 3> kThree = {
    {{-0.7745966692414834, 5.0 / 9.0}, {0.0, 8.0 / 9.0}, {0.7745966692414834, 5.0 / 9.0}}};

}  // namespace

std::vector<Node> gauss_nodes(
    double lower, double upper, std::vector<double> breaks, double spacing, int points) {
    const std::span<const Node> rule = points == 2 ? std::span<const Node>(kTwo) : kThree;
    std::erase_if(breaks, [&](double x) { return x <= lower || x >= upper; });
    breaks.push_back(lower);
    breaks.push_back(upper);
    std::sort(breaks.begin(), breaks.end());
    std::vector<Node> nodes;
    for (std::size_t piece = 0; piece + 1 < breaks.size(); ++piece) {
        const double length = breaks[piece + 1] - breaks[piece];
        if (length <= 0.0) {
            continue;
        }
        const int parts = std::max(1, static_cast<int>(std::ceil(length / (points * spacing))));
        const double half = 0.5 * length / parts;
        for (int part = 0; part < parts; ++part) {
            const double middle = breaks[piece] + (2 * part + 1) * half;
            for (const Node& node : rule) {
                nodes.push_back({middle + half * node.at_m, half * node.weight_m});
            }
        }
    }
    return nodes;
}

std::vector<ApertureRow> aperture_rows(const Aperture& aperture, glm::dvec2 spacing_m) {
    std::vector<ApertureRow> rows;
    if (!aperture.is_ellipse) {
        const std::vector<Node> x =
            gauss_nodes(-aperture.half_m.x, aperture.half_m.x, aperture.breaks_x_m, spacing_m.x);
        for (const Node& y :
             gauss_nodes(-aperture.half_m.y, aperture.half_m.y, aperture.breaks_y_m, spacing_m.y)) {
            rows.push_back({y, x});
        }
        return rows;
    }
    // y = half * sin(angle): the ellipse's width, cos(angle), is then smooth at its ends.
    std::vector<double> angles;
    for (const double y : aperture.breaks_y_m) {
        if (std::abs(y) < aperture.half_m.y) {
            angles.push_back(std::asin(y / aperture.half_m.y));
        }
    }
    const double quarter_turn = std::acos(0.0);
    for (const Node& angle :
         gauss_nodes(-quarter_turn, quarter_turn, angles, spacing_m.y / aperture.half_m.y)) {
        const double cosine = std::cos(angle.at_m);
        const double half_width_m = aperture.half_m.x * cosine;
        rows.push_back(
            {{aperture.half_m.y * std::sin(angle.at_m),
              angle.weight_m * aperture.half_m.y * cosine},
             gauss_nodes(-half_width_m, half_width_m, aperture.breaks_x_m, spacing_m.x)});
    }
    return rows;
}

}  // namespace nearfield::sample_data
