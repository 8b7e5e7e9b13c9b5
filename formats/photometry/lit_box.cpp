// SPDX-License-Identifier: Apache-2.0
#include "formats/photometry/lit_box.h"

#include "formats/files/error.h"
#include "formats/model/slab_axes.h"
#include "formats/photometry/to_lightfield.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::photometry {
namespace {

// Area of the quarter 0 ... x, 0 ... y of a disk of radius 1 about 0.
double quarter_area(double x, double y) {
    x = std::min(x, 1.0);
    y = std::min(y, 1.0);
    // Up to where the circle falls below y the height is y, from there sqrt(1 - x^2).
    const auto under_circle = [](double to) {
        return 0.5 * (to * std::sqrt(1 - to * to) + std::asin(to));
    };
    const double corner = std::min(x, std::sqrt(1 - y * y));
    return corner * y + under_circle(x) - under_circle(corner);
}

// The same of a rectangle lo ... hi, which may lie anywhere.
double disk_area(glm::dvec2 lo, glm::dvec2 hi) {
    const auto signed_area = [](double x, double y) {
        return std::copysign(1.0, x) * std::copysign(1.0, y) *
               quarter_area(std::abs(x), std::abs(y));
    };
    return signed_area(hi.x, hi.y) - signed_area(lo.x, hi.y) - signed_area(hi.x, lo.y) +
           signed_area(lo.x, lo.y);
}

}  // namespace

LitBox lit_box(const Photometry& photometry, glm::dvec2 asked_m) {
    const glm::dmat3 turn = luminaire_from_photometry(photometry.coordinates);
    LitBox box;
    box.size_m = glm::abs(turn * photometry.opening.size_m);
    if (asked_m.x > 0 && asked_m.y > 0)
        box.size_m = glm::dvec3(asked_m, box.size_m.z);
    const Shape round_seen_so =
        photometry.coordinates == Coordinates::A ? Shape::UprightEllipse : Shape::Ellipse;
    box.is_round =
        photometry.opening.shape == Shape::Ellipsoid || photometry.opening.shape == round_seen_so;
    if (!(box.size_m.x * box.size_m.y > 0))
        throw Error{"light field of photometry", "luminous opening",
                    "an area, or a size asked for (--opening-mm): light leaves from somewhere",
                    fmt::format("{} m x {} m", box.size_m.x, box.size_m.y)};
    if (box.size_m.z == 0)
        box.size_m.z = std::min(box.size_m.x, box.size_m.y);
    return box;
}

FlatOpening side_of(const LitBox& box, int slab) {
    const glm::dvec3 size_m = glm::abs(glm::transpose(model::axes_from_slab(slab)) * box.size_m);
    constexpr int kBack = 5;
    return {glm::dvec2(size_m), box.is_round && (slab == 0 || slab == kBack)};
}

double coverage(const FlatOpening& opening, const Slab& slab, int column, int row) {
    if (!opening.is_round)
        return 1;
    const glm::dvec2 radius_m = 0.5 * opening.size_m;
    const glm::dvec2 center_m = slab.basis_center_m(column, row);
    const double area = disk_area((center_m - 0.5 * slab.pitch_m) / radius_m,
                                  (center_m + 0.5 * slab.pitch_m) / radius_m);
    return std::clamp(area * radius_m.x * radius_m.y / (slab.pitch_m.x * slab.pitch_m.y), 0.0, 1.0);
}

}  // namespace nearfield::photometry
