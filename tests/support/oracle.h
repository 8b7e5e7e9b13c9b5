// SPDX-License-Identifier: Apache-2.0
/// What the model must give, by direct numerical integration of definitions in double precision.
///
/// Nothing here is shared with formats/model: radiance comes from the sum over images, the
/// irradiance is
///     E = integral over U of L(u -> s) max(0, cos(receiver)) cos(U) / R^2 du
/// with its kernel as it stands. U is cut along the edges of the basis' cells, along the texels'
/// edges seen from the receiver and along the receiver's own plane; on each piece, where the
/// integrand is smooth, Gauss-Legendre quadrature of `order` points an axis is used (collapsed to
/// triangles where the receiver's plane cuts). Pieces are at most half as long as they are far from
/// the receiver, so that the error falls as 8^(-2 order). Colors are (R, G, B), one channel gives Y
/// three times, as in formats/model/luminaire.h.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/luminaire.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::support {

struct OracleOptions {
    int order =
        8;  // quadrature points a piece and axis; 8 is converged to 1e-13, checked against 16
    /// Coefficients in double instead of the slab's floats, same shape; empty: the slab's.
    std::span<const double> coeffs = {};
};

/// L(u -> s), every image asked.
glm::dvec3 oracle_radiance(const Slab& slab, glm::dvec2 u_m, glm::dvec2 s_m);

/// Irradiance at a receiver in the slab's (the luminaire's) frame. 0 at U and behind it.
glm::dvec3 oracle_irradiance(const Slab& slab,
                             const model::Receiver& receiver,
                             const OracleOptions& options = {});
glm::dvec3 oracle_irradiance(const LightField& lightfield,
                             const model::Receiver& receiver,
                             const OracleOptions& options = {});

/// The same for many receivers in parallel.
std::vector<glm::dvec3> oracle_irradiance(const Slab& slab,
                                          std::span<const model::Receiver> receivers,
                                          const OracleOptions& options = {});

/// Integral of L cos(theta) over U for a fixed direction in the slab's frame, which need not be of
/// unit length.
glm::dvec3 oracle_intensity(const Slab& slab,
                            glm::dvec3 direction,
                            const OracleOptions& options = {});

/// Integral of L cos^4(theta) / delta^2 over U and S, in four dimensions: for small lamps.
glm::dvec3 oracle_flux(const Slab& slab, int order = 5);

/// A mean and its standard error, per channel.
struct Estimate {
    glm::dvec3 mean{0.0};
    glm::dvec3 standard_error{0.0};
};

/// Irradiance by `count` points on U, uniform in the rectangle that holds every basis function's
/// support.
Estimate oracle_monte_carlo(const Slab& slab,
                            const model::Receiver& receiver,
                            int count,
                            std::uint64_t seed);

/// The receiver in the slab's frame.
model::Receiver receiver_slab_from_luminaire(const Slab& slab, const model::Receiver& receiver);

}  // namespace nearfield::support
