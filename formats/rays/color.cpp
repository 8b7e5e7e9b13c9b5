// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/color.h"

#include <algorithm>
#include <cmath>

namespace nearfield::rays {
namespace {

// A Gaussian whose width differs on its two sides.
double lobe(double x, double center, double width_below, double width_above) {
    const double t = (x - center) / (x < center ? width_below : width_above);
    return std::exp(-0.5 * t * t);
}

// XYZ to linear Rec.709 with D65 (ITU-R BT.709-6), Y in the same unit. By columns.
const glm::dmat3 kRec709FromXyz{3.2409699,  -0.9692436, 0.0556301, -1.5373832, 1.8759675,
                                -0.2039770, -0.4986108, 0.0415551, 1.0569715};

}  // namespace

glm::dvec3 color_matching(double wavelength_nm) {
    const double l = wavelength_nm;
    return {1.056 * lobe(l, 599.8, 37.9, 31.0) + 0.362 * lobe(l, 442.0, 16.0, 26.7) -
                0.065 * lobe(l, 501.1, 20.4, 26.2),
            0.821 * lobe(l, 568.8, 46.9, 40.5) + 0.286 * lobe(l, 530.9, 16.3, 31.1),
            1.217 * lobe(l, 437.0, 11.8, 36.0) + 0.681 * lobe(l, 459.0, 26.0, 13.8)};
}

UnitColor unit_color(glm::dvec3 xyz) {
    if (!(xyz.y > 0.0))
        return {};
    const glm::dvec3 c = xyz / xyz.y;
    glm::dvec3 rgb = kRec709FromXyz * c;
    const double least = std::min({rgb.x, rgb.y, rgb.z});
    const bool desaturated = least < 0.0;
    if (desaturated)
        rgb = glm::max(glm::dvec3(0.0), 1.0 + (rgb - 1.0) / (1.0 - least));
    // The matrix' rounding and the clamp leave Y off by some 1e-7: take it out.
    const double y = 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
    return {rgb / y, desaturated};
}

glm::dvec3 xyz_of(glm::dvec3 rgb) {
    return glm::inverse(kRec709FromXyz) * rgb;
}

}  // namespace nearfield::rays
