// SPDX-License-Identifier: Apache-2.0
// Geometry of the grids that directions.cpp fits: basis functions on U, blocks on S.
#include "formats/model/profile.h"
#include "formats/rays/directions.h"

#include <algorithm>

namespace nearfield::rays {

double Aperture::integral_m2() const {
    const double one = model::integral(profile);
    return one * one * pitch_m.x * pitch_m.y;
}

Aperture cover(const Profile& profile, const Rectangle& rectangle, glm::ivec2 grid) {
    const glm::dvec2 cells(grid - static_cast<int>(profile.cells.size()) + 1);
    return {profile, grid, (rectangle.max_m - rectangle.min_m) / cells,
            0.5 * (rectangle.min_m + rectangle.max_m)};
}

glm::ivec2 square_grid(const Profile& profile, const Rectangle& rectangle, int cells) {
    const glm::dvec2 size = rectangle.max_m - rectangle.min_m;
    const double pitch = std::max(size.x, size.y) / cells;
    return glm::max(glm::ivec2(1), glm::ivec2(glm::ceil(size / pitch - 1e-9))) +
           static_cast<int>(profile.cells.size()) - 1;
}

BlockWeights weights_at(glm::ivec2 blocks, const Rectangle& s, glm::dvec2 s_m) {
    const glm::dvec2 x =
        glm::clamp((s_m - s.min_m) / (s.max_m - s.min_m) * glm::dvec2(blocks) - 0.5,
                   glm::dvec2(0.0), glm::dvec2(blocks - 1));
    const glm::ivec2 low(
        glm::min(glm::floor(x), glm::max(glm::dvec2(0.0), glm::dvec2(blocks - 2))));
    const glm::ivec2 high = glm::min(low + 1, blocks - 1);
    const glm::dvec2 f = x - glm::dvec2(low);
    const auto index = [&](int i, int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(blocks.x) +
               static_cast<std::size_t>(i);
    };
    return {
        {index(low.x, low.y), index(high.x, low.y), index(low.x, high.y), index(high.x, high.y)},
        {(1 - f.x) * (1 - f.y), f.x * (1 - f.y), (1 - f.x) * f.y, f.x * f.y}};
}

}  // namespace nearfield::rays
