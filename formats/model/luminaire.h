// SPDX-License-Identifier: Apache-2.0
/// The light of a light field, in double precision and exact: the reference of everything that is
/// faster.
///
/// Colors are (R, G, B); a one-channel light field gives Y in all three. Units follow the light
/// field's quantity: cd/m^2, lm, cd and lx, or W/(m^2 sr), W, W/sr and W/m^2. Functions of a Slab
/// speak the slab's frame, functions of a LightField the luminaire's. None throws; all are zero
/// where there is no light. Source: design of the estimators after Lu, Pacanowski, Granier,
/// "Position-dependent importance sampling of light field luminaires", 2015; formulas re-derived in
/// ARCHITECTURE.md, "The model".
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

namespace nearfield::model {

/// A shaded point and its unit normal.
struct Receiver {
    glm::dvec3 position_m{0.0};
    glm::dvec3 normal{0.0, 0.0, -1.0};
};

/// A receiver of the luminaire's frame in the slab's.
Receiver to_slab(const Slab& slab, const Receiver& receiver);

/// L(u -> s): u on U, s on S.
glm::dvec3 radiance(const Slab& slab, glm::dvec2 u_m, glm::dvec2 s_m);

/// All light that leaves: integral of L cos^4(theta) / delta^2 over U and S.
glm::dvec3 flux(const Slab& slab);
glm::dvec3 flux(const LightField& lightfield);

/// Standard deviation of flux's Y from the spread of replicates, else from the coefficients' sigma
/// (Slab::sigma; 0 where unknown) as if independent; without the common scale's.
double flux_sigma_y(const LightField& lightfield);

/// Far-field intensity in a direction (need not be of unit length).
glm::dvec3 intensity(const Slab& slab, glm::dvec3 direction);
glm::dvec3 intensity(const LightField& lightfield, glm::dvec3 direction);

/// Unshadowed irradiance by the windowed sum. Irradiance weighting: exact to rounding. Radiance
/// weighting: relative error below 1e-4 (quadrature nodes are refined until the 1/R^4 kernel is
/// resolved).
glm::dvec3 irradiance(const Slab& slab, const Receiver& receiver);
glm::dvec3 irradiance(const LightField& lightfield, const Receiver& receiver);

/// Standard deviation of irradiance's Y from the spread of replicates, else from the coefficients'
/// sigma as if independent, and the common scale's.
/// Cost    of an irradiance a replicate; without them of one.
double irradiance_sigma_y(const LightField& lightfield, const Receiver& receiver);

/// Luminance (or radiometric total) of a color.
double luminance(glm::dvec3 rgb);

}  // namespace nearfield::model
