// SPDX-License-Identifier: Apache-2.0
/// From spectra to color. Source of the color matching functions: Wyman, Sloan, Shirley, "Simple
/// analytic approximations to the CIE XYZ color matching functions", JCGT 2(2), 2013, the
/// multi-lobe fit of the 2 degree observer (largest error 0.02 of the functions' peak).
#pragma once

#include <glm/glm.hpp>

namespace nearfield::rays {

/// Luminous efficacy at the peak of photopic vision, lm/W (SI's definition gives 683.002 with V at
/// 555 nm in air).
constexpr double kPeakEfficacyLmPerW = 683.002;

/// CIE 1931 color matching functions x, y, z at a wavelength; 0 far outside 360 ... 830 nm.
glm::dvec3 color_matching(double wavelength_nm);

/// Color per unit of Y: linear Rec.709 with Y = 1, moved towards white at equal Y until no channel
/// is negative.
struct UnitColor {
    glm::dvec3 rgb{1.0};
    bool desaturated = false;
};

/// xyz need not be normalized; xyz.y <= 0 gives white.
UnitColor unit_color(glm::dvec3 xyz);

/// CIE XYZ of a color in linear Rec.709. This is the inverse of unit_color, for colors with Y = 1.
glm::dvec3 xyz_of(glm::dvec3 rgb);

}  // namespace nearfield::rays
