// SPDX-License-Identifier: Apache-2.0
/// The photometry of a light field: what a goniophotometer would measure of the lamp from afar.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/photometry/photometry.h"

namespace nearfield::photometry {

struct TableOptions {
    int planes = 72;          // C planes of the circle, a multiple of 4, 4 ... 3600
    int quarter_angles = 90;  // steps of gamma from 0 to 90 degrees, 2 ... 1800
};

/// The coarsest of a few tables, each twice as fine as the one before, whose flux agrees with the
/// light field's within `most_error_rel`; the finest (C and gamma every 1/4 degree) where none
/// does.
TableOptions choose_table(const LightField& lightfield, double most_error_rel = 5e-4);

/// Absolute photometry of type C; its frame is the luminaire's. Gamma ends at 90 degrees where all
/// light goes forward (one slab), else at 180. The opening is the smaller of the first slab's
/// rectangles on S and on U: light leaves where its rays are narrow.
///
/// Throws  Error for options out of range, and for radiometric light fields: candela are asked for.
/// Cost    a far-field intensity (model/luminaire.h) a table entry; exact at the table's angles.
Photometry photometry_of(const LightField& lightfield, const TableOptions& options = {});

}  // namespace nearfield::photometry
