// SPDX-License-Identifier: Apache-2.0
/// Where the light of a photometry is assumed to leave: a box about the photometric center.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/photometry/photometry.h"

#include <numbers>

namespace nearfield::photometry {

/// A side of the box.
struct FlatOpening {
    glm::dvec2 size_m{0.0};
    bool is_round = false;

    double area_m2() const { return size_m.x * size_m.y * (is_round ? std::numbers::pi / 4 : 1); }
};

/// The box in the luminaire's frame.
struct LitBox {
    glm::dvec3 size_m{0.0};
    bool is_round = false;  // seen along the beam
};

/// The photometry's opening, of the size asked for where that is > 0; where no height is stated it
/// is the shorter side. Throws Error where it has no area seen along the beam.
LitBox lit_box(const Photometry& photometry, glm::dvec2 asked_m);

/// The side of the box that slab 0 ... 5 looks out of.
FlatOpening side_of(const LitBox& box, int slab);

/// How much of a cell of U the opening covers, 0 ... 1.
double coverage(const FlatOpening& opening, const Slab& slab, int column, int row);

}  // namespace nearfield::photometry
