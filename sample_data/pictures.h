// SPDX-License-Identifier: Apache-2.0
/// Pictures of a light field for people: what it stores, and what it looks like.
#pragma once

#include "formats/files/lightfield.h"
#include "sample_data/headlight.h"

#include <glm/glm.hpp>

#include <vector>

namespace nearfield::sample_data {

/// 8-bit sRGB pixels, [row from the top][column][r, g, b].
struct PixelImage {
    glm::ivec2 size_px{0};
    std::vector<unsigned char> rgb;
};

/// All images C_m of the first slab side by side as seen from the lamp's front (x to the right),
/// each reduced to at most max_texels_px wide, cube-root scale up to the brightest texel.
PixelImage atlas_picture(const LightField& lightfield, int max_texels_px);

/// The lens as seen from far away along -direction, once by formula (top row) and once by the light
/// field (bottom row), a column a direction, each column scaled to its brightest; height_px high
/// each. The eye looks at the lens, so +x is to the right.
PixelImage lens_picture(const Headlight& headlight,
                        const LightField& lightfield,
                        const std::vector<glm::dvec2>& tangents,
                        int height_px);

}  // namespace nearfield::sample_data
