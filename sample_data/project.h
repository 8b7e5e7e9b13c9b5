// SPDX-License-Identifier: Apache-2.0
/// Projects a lamp whose radiance is a formula onto a light field's basis.
#pragma once

#include "formats/files/lightfield.h"
#include "sample_data/aperture.h"

#include <glm/glm.hpp>

#include <functional>
#include <span>

namespace nearfield::sample_data {

/// A lamp known by formula, seen through a slab's planes.
struct Source {
    Aperture aperture;  // where on U it shines from
    /// L(u -> s) for one u, one s.y and many s.x; rgb is [channel][i]. Called from many threads.
    std::function<void(
        glm::dvec2 u_m, double s_y_m, std::span<const double> s_x_m, std::span<double> rgb)>
        radiance_row;
};

struct ProjectOptions {
    int refine = 1;  // multiplies the number of quadrature nodes along u and s, each axis; 1 ... 8
    std::function<void(double fraction)>
        progress;  // may be empty; called from one thread at a time
};

/// How exact the projection is. Relative numbers are relative to the lamp's flux.
struct ProjectFigures {
    double flux_lm = 0;  // Y, by the projection's own quadrature of the formula
    double quadrature_error =
        0;  // RMS change of the data b when all nodes are doubled, relative to b's RMS
    double negative_share =
        0;  // light that the unconstrained solution holds in negative coefficients
    double rescaled_share = 0;  // light that the rescaling to each texel's flux moved
    double time_s = 0;
};

struct Projection {
    Slab slab;
    ProjectFigures figures;
};

/// Least squares on every texel of S: for f(u), the texel's mean of L cos^4 / delta^2 (irradiance
/// weighting) or of L (radiance weighting), finds c >= 0 that minimizes the integral over U of (f -
/// sum c_m Phi_m)^2, then scales the texel's c so that the integral of sum c_m Phi_m is f's
/// (irradiance weighting: the texel's flux is exact).
///
/// In      source; planes: a slab without coefficients.
/// Out     slab with coefficients; channels: 3 or 1 (luminance).
/// Throws  Error if the planes are not usable: also a grid above 512 along an axis, or above 2^30
/// coefficients.
/// Cost    O(texels x lens nodes); 11 x 9 x 256 x 256 RGB: seconds (README.md). Parallel over rows
/// of S (TBB).
Projection project(const Source& source, const Slab& planes, const ProjectOptions& options);

}  // namespace nearfield::sample_data
