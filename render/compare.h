// SPDX-License-Identifier: Apache-2.0
/// A picture beside another of the same view: another device's, another sampler's, another day's.
#pragma once

#include "formats/files/image.h"
#include "render/metrics.h"

#include <string>

namespace nearfield::render {

struct Comparison {
    RelativeError radiance_y;  // of pixels whose reference exceeds 1e-3 of its largest
    double lab = 0;            // lab_difference() of the default layers
};

/// Adds the layer "error" (Y) to the picture: radiance Y over the reference's, less 1; 0 where the
/// reference is 1e-3 of its largest or less. Throws Error if sizes differ or one of the two has no
/// default layer of three channels.
Comparison compare_pictures(Picture& picture, const Picture& reference);

/// For people, in one line.
std::string summary(const Comparison& comparison);

}  // namespace nearfield::render
