// SPDX-License-Identifier: Apache-2.0
/// Symmetries that files use to leave planes out.
#pragma once

#include "formats/photometry/photometry.h"

namespace nearfield::photometry {

enum class Symmetry {
    None,
    Axial,      // the same in all planes: one plane, C0
    AcrossC0,   // mirrored at the plane C0-C180: planes 0 ... 180; types A and B: H 0 ... most
    AcrossC90,  // mirrored at C90-C270: planes 90 ... 270
    Quadrants,  // mirrored at both: planes 0 ... 90
};

/// Completes a table that holds the planes a symmetry needs.
void unfold(Photometry& photometry, Symmetry symmetry);

/// The symmetry that leaves out most and is exact: mirrored planes are there and equal to the bit.
Symmetry symmetry_of(const Photometry& photometry);

/// Indices of the planes that a file with the symmetry holds.
std::vector<std::size_t> planes_kept(const Photometry& photometry, Symmetry symmetry);

}  // namespace nearfield::photometry
