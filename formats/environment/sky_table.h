// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/environment/latlong.h"

namespace nearfield::environment {

/// Draws directions in proportion to luminance, by the CDFs that luminaires' images are drawn by.
struct SkyTable {
    glm::ivec2 size_px{0};
    std::vector<float> column_cdf;  // [w + 1] over columns, 0 ... 1; all zero where all is dark
    std::vector<float> row_cdf;     // [w][h + 1] over the rows of each column

    bool is_dark() const { return column_cdf.empty() || column_cdf.back() == 0.0F; }
};

/// Cost  O(pixels), in double.
SkyTable make_sky_table(const LatLong& picture);

struct SkySample {
    glm::vec3 direction{0.0F, 1.0F, 0.0F};
    glm::ivec2 pixel{0};
    float density = 0.0F;  // per solid angle; 0: all is dark
};

/// Evenly within the pixel that is drawn. xi: uniform in [0, 1)^2.
SkySample draw(const SkyTable& table, glm::vec2 xi);

/// Density of draw() per solid angle.
float density(const SkyTable& table, glm::vec3 direction);

}  // namespace nearfield::environment
