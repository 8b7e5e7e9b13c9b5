// SPDX-License-Identifier: Apache-2.0
/// A photometry as a light field: the far field that was measured, from an opening of the size that
/// the file states.
///
/// A photometric file knows nothing of where on the lamp light leaves. Assumed is what planners
/// assume of area sources: the opening is flat and looks along the beam, and each of its points
/// shines as the whole lamp does,
///     L(u, d) = I(d) / (A cos theta),
/// so that intensity is the file's and illuminance at every distance follows. Light that one flat
/// opening cannot send (aside, behind) leaves the sides and the back of a box about it in the same
/// way, one slab a side. What a lamp shows to somebody near is not in it.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/photometry/photometry.h"

#include <optional>

namespace nearfield::photometry {

struct LightFieldOptions {
    /// 1: directions within the half angle, 5: all but those that go mainly backwards, 6: all,
    /// shared out by model::slab_shares. Default: the fewest that lose < 1 %.
    std::optional<int> slabs;
    /// With one slab light beyond this angle from the beam's axis is left out, along x and y each,
    /// 1 ... 85 degrees: S grows with its tangent.
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
    LightField lightfield;     // irradiance weighting, one channel, box profile
    double photometry_lm = 0;  // flux of the photometry, all around
    double lightfield_lm = 0;  // of the light field
    /// Where light was left out: the angles from the beam's axis between which table directions
    /// with light have no slab. None: least > most.
    double least_lost_deg = 180, most_lost_deg = 0;
};

/// Turns a direction of the photometry's frame into the luminaire's: +z along the beam. Types C and
/// B look down +z already; type A's beam, along +x, becomes +z, and V > 0 +y.
glm::dmat3 luminaire_from_photometry(Coordinates coordinates);

/// U is the opening, in cells by the share of them that it covers (an ellipse's edge); S is
/// parallel to it, before it. C_m is the texel's mean of w I cos^3(theta) / (A delta^2), seen from
/// the cell's center, by 3 x 3 Gauss nodes a texel; w is the slab's share of the direction, 1 with
/// one slab. The U of all slabs pass through the photometric center; where the file states no
/// height the box is as high as its shorter side.
///
/// Throws  Error for options out of range, and where the opening has no area: a point, an upright
///         shape seen edge-on, and no size is asked for.
/// Cost    9 lookups a texel and cell: 256 x 256 texels and 4 x 4 cells in about a second a slab
///         and thread.
FarLightField to_lightfield(const Photometry& photometry, const LightFieldOptions& options = {});

}  // namespace nearfield::photometry
