// SPDX-License-Identifier: Apache-2.0
/// A photometry as a light field: the far field that was measured, from an opening of the size that
/// the file states.
///
/// A photometric file knows nothing of where on the lamp light leaves. Assumed is what planners
/// assume of area sources: the opening is flat and looks along the beam, and each of its points
/// shines as the whole lamp does,
///     L(u, d) = I(d) / (A cos theta),
/// so that intensity is the file's and illuminance at every distance follows. Heights of the
/// opening, its sides' own light and what a lamp shows to somebody near are not in it.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/photometry/photometry.h"

namespace nearfield::photometry {

struct LightFieldOptions {
    /// Light beyond this angle from the beam's axis is left out, along x and y each, 1 ... 85
    /// degrees: S grows with its tangent.
    double half_angle_deg = 70;
    /// S lies as many of the opening's longer sides before it, >= 1. More: sharper directions, of
    /// 1 / (cells * delta_sides) rad each; fewer: S nearer to the lamp.
    double delta_sides = 10;
    int cells = 4;     // of the opening along its longer side, 1 ... 64
    int texels = 256;  // of S along its longer side, 8 ... 4096
    /// The opening's size, in the luminaire's frame; 0: what the file states.
    glm::dvec2 opening_m{0.0};
};

struct FarLightField {
    LightField lightfield;     // one slab, irradiance weighting, one channel, box profile
    double photometry_lm = 0;  // flux of the photometry, all around
    double lightfield_lm = 0;  // of the light field: what lies within the half angle
};

/// Turns a direction of the photometry's frame into the luminaire's: +z along the beam. Types C and
/// B look down +z already; type A's beam, along +x, becomes +z, and V > 0 +y.
glm::dmat3 luminaire_from_photometry(Coordinates coordinates);

/// U is the opening, in cells by the share of them that it covers (an ellipse's edge); S is
/// parallel to it, before it. C_m is the texel's mean of I cos^3(theta) / (A delta^2), seen from
/// the cell's center, by 3 x 3 Gauss nodes a texel.
///
/// Throws  Error for options out of range, and where the opening has no area: a point, an upright
///         shape seen edge-on, and no size is asked for.
/// Cost    9 lookups a texel and cell: 256 x 256 texels and 4 x 4 cells in about a second.
FarLightField to_lightfield(const Photometry& photometry, const LightFieldOptions& options = {});

}  // namespace nearfield::photometry
