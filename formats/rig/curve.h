// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/rig/rig.h"

namespace nearfield::rig {

/// A curve at x: linear between its points, its end values beyond them. `without` where it has no
/// points.
double value_at(const Curve& curve, double x, double without);

/// Digital numbers as a camera that is linear would have given them.
double linear_dn(const Radiometry& radiometry, double dn);

}  // namespace nearfield::rig
