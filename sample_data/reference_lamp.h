// SPDX-License-Identifier: Apache-2.0
/// The reference lamp: a lamp of full size (11 x 9 images of 256 x 256 texels, one channel,
/// B-spline basis, irradiance weighting, delta 0.2 m) and 300 receivers, on which estimators are
/// compared. Facets steer beams, a hot spot lies under a cut-off line, the lens is round; its unit
/// of light is arbitrary.
///
/// C_m is not fitted: it is the formula's L cos^4 / delta^2 from the basis function's center to the
/// texel's center.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"

#include <vector>

namespace nearfield::sample_data {

/// L along u -> s.
double reference_radiance(glm::dvec2 u_m, glm::dvec2 s_m);

/// The coefficients in double, [m][j][i]: what the slab's floats round.
std::vector<double> reference_coeffs();

LightField make_reference_lamp();

/// 300 receivers 0.5 ... 6.5 m ahead of S, normals within 60 degrees of -z.
std::vector<model::Receiver> reference_receivers();

}  // namespace nearfield::sample_data
