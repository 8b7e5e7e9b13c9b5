// SPDX-License-Identifier: Apache-2.0
/// Directions, lookups and sums of a photometry.
///
/// Directions are in the photometry's frame: right-handed, +z straight down out of the lamp
/// (LM-63's photometric zero), +x towards C0, hence C90 at -y, since C counts counterclockwise seen
/// from above.
#pragma once

#include "formats/photometry/photometry.h"

namespace nearfield::photometry {

/// A direction by a plane and an angle in it, degrees.
struct Angles {
    double plane_deg = 0, angle_deg = 0;
};

/// The unit vector of a direction:
///     C: (sin g cos C, -sin g sin C, cos g)
///     B: (cos H sin V, sin H, cos H cos V)
///     A: (cos V cos H, cos V sin H, -sin V)
glm::dvec3 direction_of(Coordinates coordinates, Angles angles);

/// Its inverse; C in [0, 360), H and V of types A and B in [-180, 180]; at a pole, where any
/// azimuth is meant, 0. The vector need not be unit.
Angles angles_of(Coordinates coordinates, const glm::dvec3& direction);

/// Candela, bilinear between the table's angles; 0 where the file has no angles.
double intensity_cd(const Photometry& photometry, Angles angles);
double intensity_cd(const Photometry& photometry, const glm::dvec3& direction);

/// The flux of the bilinear interpolant, integrated exactly, through directions at most
/// `most_polar_deg` from +z (type C; types A and B: the whole table).
double flux_lm(const Photometry& photometry, double most_polar_deg = 180);

/// Scales all intensities to a flux of the whole. Throws Error where there is no light.
void scale_to(Photometry& photometry, double flux_lm);

/// The largest intensity, which the interpolant takes at one of the table's angles.
struct Peak {
    double intensity_cd = 0;
    Angles angles;
};
Peak peak(const Photometry& photometry);

}  // namespace nearfield::photometry
