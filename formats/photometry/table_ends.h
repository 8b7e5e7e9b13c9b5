// SPDX-License-Identifier: Apache-2.0
/// What the first and last angles of a file's table say: shared by formats that name no symmetry.
#pragma once

#include "formats/photometry/photometry.h"
#include "formats/photometry/symmetry.h"

#include <string>

namespace nearfield::photometry {

/// A file of type C says by its last plane which symmetry it leaves planes out by; types A and B by
/// beginning at 0. Throws Error naming `where` where the planes end at none of the standard's ends.
Symmetry symmetry_by_last_plane(Photometry& photometry, const std::string& where);

/// Ends that files round become what they mean, and a circle without its last plane is closed.
void close_circle(Photometry& photometry);

/// Notes where a table of type C leaves directions dark by ending early.
void note_missing_angles(Photometry& photometry);

}  // namespace nearfield::photometry
