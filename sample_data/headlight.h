// SPDX-License-Identifier: Apache-2.0
/// A synthetic low beam for right-hand traffic whose radiance is a formula: the truth of samples
/// and tests.
///
/// Frame: the luminaire's, turned about nothing, its origin on the lens: +z is where light goes, +y
/// up, so +x points to the driver's LEFT. The lens is the ellipse |(u.x / 0.080, u.y / 0.065)| <= 1
/// m at z = 0. A direction is given by its tangents t = d_xy / d_z. With the beam's own coordinates
/// (x to the driver's right)
///
///     x = -(t.x + u.x / F),   y = t.y + u.y / F        F = 16 m, where all of the lens aims its
///     cut-off
///
/// the radiance in channel c through facet f (32 x 26 mm, its role drawn from the seed) is
///
///     L_c(u, t) = K * W(x, y) * (color_c * gain_f * B_f(x, y) * S_c(y - y_cut(x)) + stray_c(y))
///     B_f = peak * bell((x - x_f) / a) * bell((y - y_f) / b),   bell(z) = 1 / (1 + z^2)^2
///     y_cut(x) = -0.010 + tan(15 deg) * clamp(x, 0, 0.18)       the kink: level on the left,
///     rising on the right S_c(y)   = smooth step from 1 to 0, center and width by channel: the
///     color fringe W        = smooth window, 1 inside the beam, exactly 0 outside tan +-0.62 wide,
///     -0.222 ... 0.061 high
///
/// and zero outside the lens. K is set so that the flux is 1000 lm.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"
#include "sample_data/project.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace nearfield::sample_data {

/// What one facet of the lens adds to its role.
struct Facet {
    int role = 0;           // index of the beam part that it serves: hot spot, spread, foreground
    glm::dvec2 steer{0.0};  // its beam's center relative to the role's, tangents
    double gain = 1;
};

struct Headlight {
    std::vector<Facet>
        facets;              // row by row from the lens' lower right corner as seen from its front
    double scale_cd_m2 = 1;  // K
};

/// Semi-axes of the lens.
constexpr glm::dvec2 kLensHalf_m{0.080, 0.065};
/// The beam's window in tangents, in the luminaire's axes: no light leaves outside of it (but for u
/// / F).
constexpr glm::dvec2 kBeamMin{-0.62, -0.222}, kBeamMax{0.62, 0.061};
/// Tangent of the level part of the cut-off: 1 % downwards, as a low beam is aimed.
constexpr double kCutoffTangent = -0.010;
/// All parts of the lens aim their cut-off at one line at this distance.
constexpr double kFocus_m = 16.0;

/// The lamp of a seed: seeds differ in the pattern of the facets. Its flux is 1000 lm.
Headlight make_headlight(std::uint64_t seed = 1);

/// L(u, t) in cd/m^2, R G B; t are the direction's tangents.
glm::dvec3 radiance(const Headlight& headlight, glm::dvec2 u_m, glm::dvec2 tangent);

/// L for one lens point, one tangent t.y and many t.x; rgb is [channel][i].
void radiance_row(const Headlight& headlight,
                  glm::dvec2 u_m,
                  double tangent_y,
                  std::span<const double> tangent_x,
                  std::span<double> rgb);

/// Flux by quadrature of the formula, lm.
glm::dvec3 flux(const Headlight& headlight);

/// Far-field intensity in a direction by quadrature of the formula, cd.
glm::dvec3 intensity(const Headlight& headlight, glm::dvec3 direction);

/// Unshadowed irradiance by quadrature of the formula, lx; the receiver's frame has z = 0 on the
/// lens.
glm::dvec3 irradiance(const Headlight& headlight, const model::Receiver& receiver_lens);

/// The lens and its facets' edges.
Aperture headlight_aperture();

/// Radiance from lens to points on S, delta_m ahead of it, for project().
Source headlight_source(const Headlight& headlight, double delta_m);

/// Empty slab (no coefficients) that holds all of the beam: the basis grid covers the lens, S the
/// beam's window.
Slab headlight_planes(double delta_m,
                      glm::ivec2 grid,
                      glm::ivec2 texels,
                      const std::string& basis,
                      Weighting weighting,
                      int channels);

}  // namespace nearfield::sample_data
