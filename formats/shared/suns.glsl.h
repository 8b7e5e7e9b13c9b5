// SPDX-License-Identifier: Apache-2.0
// Small suns apart from filtered samples: of a sun that few samples reach, filters keep the light
// only on average.
#ifndef NEARFIELD_SUNS_GLSL_H
#define NEARFIELD_SUNS_GLSL_H

#include "formats/shared/portable.glsl.h"

SHARED_BEGIN

// Share of the suns' light that a lobe takes from the maps; the rest is summed sun by sun as if
// they were points, to which a lobe must be wider than they are. Radii: of the lobe
// (brdf_lobe_width_rad), and of the largest sun.
GPU_FN float suns_in_maps(float lobe_rad, float sun_rad) {
    return clamp(2.0f - lobe_rad / sun_rad, 0.0f, 1.0f);
}

SHARED_END

#endif
