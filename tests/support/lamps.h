// SPDX-License-Identifier: Apache-2.0
/// Small lamps with known, awkward properties, and one of full size: the same on every machine.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace nearfield::support {

/// A piecewise quadratic profile of four cells that is neither even nor smooth: what a measured
/// filter may be.
Profile measured_profile();

/// The four named profiles and measured_profile().
std::vector<Profile> all_profiles();

/// What random_lamp() makes. The defaults have nothing symmetric: W != H, w != h, pitches, texels
/// and centers differ.
struct LampShape {
    glm::ivec2 grid{5, 4};
    glm::ivec2 texels{24, 20};
    double delta_m = 0.2;
    glm::dvec2 pitch_m{0.021, 0.016};
    glm::dvec2 u_center_m{0.004, -0.007};
    glm::dvec2 s_min_m{-0.13, -0.09}, s_max_m{0.17, 0.11};
    int channels = 1;
    double decades = 4;          // coefficients spread evenly over this many powers of ten
    double dark_fraction = 0.3;  // share of texels that are zero
};

/// Coefficients independent of each other: log-uniform up to 100, or dark.
Slab random_lamp(const Profile& profile,
                 Weighting weighting,
                 std::uint64_t seed,
                 const LampShape& shape = {});

/// The slab with its geometry times `factor` and its radiance kept.
Slab scaled_lamp(const Slab& slab, double factor);

/// A rotation about a unit axis.
glm::dmat3 rotation_about(glm::dvec3 axis, double angle_rad);

/// A headlight of 11 x 9 images of 256 x 256 texels (one channel): facets that steer beams, a hot
/// spot under a cut-off line, a faint floor, a round lens. B-spline basis, irradiance weighting.
Slab reference_lamp();

/// The reference lamp's coefficients before rounding to float.
std::vector<double> reference_lamp_coeffs();

/// 300 receivers 0.5 m to 6.5 m before the reference lamp, normals within 60 degrees of -z.
std::vector<model::Receiver> reference_receivers();

}  // namespace nearfield::support
