// SPDX-License-Identifier: Apache-2.0
/// From a camera's picture to texels of S: means over the pixels that a texel covers.
///
/// A texel's four corners are seen as a quadrilateral of the picture. Its value is the mean of the
/// picture, constant on pixels, over that quadrilateral: weights are areas of polygons, exact, so
/// that nothing aliases and light is neither lost nor counted twice. A mosaic's color lives on the
/// lattice of its own pixels, each standing for the square of 2 x 2 pixels around its center; green
/// is the mean of its two lattices. Texels smaller than a lattice's cell are interpolated
/// bilinearly between centers instead: the picture's resolution is then the cell, not the texel.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace nearfield::fit {

/// The texels of S, as a light field has them: row j rises with y.
struct TexelGrid {
    glm::ivec2 texels{0};
    glm::dvec2 s_min_m{0}, s_max_m{0};
};

/// Picture position of a point of S (slab, z = 0), pixels from the picture's upper left corner;
/// none where it is not seen.
using ProjectS = std::function<std::optional<glm::dvec2>(glm::dvec2 s_m)>;

struct Tap {
    std::uint32_t pixel = 0;  // row from the top * columns + column
    float weight = 0;
};

/// Weights of every texel; for one picture or many of the same geometry.
struct RectifyMap {
    glm::ivec2 texels{0}, size_px{0};
    std::vector<std::uint32_t> begin;  // [j][i], and one more: offsets in `taps`
    std::vector<Tap> taps;             // weights of a texel add up to what is seen of it, <= 1
    std::vector<std::uint8_t> is_interpolated;  // [j][i]
    double texel_cells_least = 0;               // a texel's least width in lattice cells
    double interpolated_share = 0;              // of all texels
    /// Mean correlation of the errors of texels side by side, from pixels that they share.
    double neighbor_correlation = 0;
};

/// Weights for one color of a mosaic ("mono", "rggb", "grbg", "gbrg", "bggr"), channel 0, 1, 2 for
/// R, G, B; "mono" has channel 0 alone.
/// Throws Error for another mosaic or channel.
/// Cost    O(texels + pixels). Parallel over rows of texels (TBB); the projection is called
///         from many threads.
RectifyMap make_rectify_map(const TexelGrid& grid,
                            glm::ivec2 size_px,
                            const std::string& mosaic,
                            int channel,
                            const ProjectS& project_px);

/// Texels' values and variances, [j][i]; variance infinite: missing.
struct RectifiedImage {
    std::vector<float> value, variance;
};

/// Texel means. A pixel of infinite variance is left out; a texel of which less than `least_share`
/// is left, is missing. Pixels' errors are taken as independent.
RectifiedImage rectify(const RectifyMap& map,
                       std::span<const float> value,
                       std::span<const float> variance,
                       double least_share = 0.75);

}  // namespace nearfield::fit
