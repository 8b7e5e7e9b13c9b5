// SPDX-License-Identifier: Apache-2.0
/// The veil of a lens: a share of the light arrives spread wide about where it belongs.
///
///     P = (1 - v) I + v G * I,      G a gaussian of sigma_px, I the picture without veil
///
/// Light from beyond the picture's border is not known and adds nothing: the real veil near the
/// border is larger by what bright things just outside would add.
#pragma once

#include "formats/rig/rig.h"

#include <glm/glm.hpp>

#include <span>
#include <string>
#include <vector>

namespace nearfield::rig {

/// G * I of one color's picture, [row from the top][column]. Values beyond the border are zero.
/// Blocks of a fifth of sigma_px carry it: on even and on slowly changing light exact to 1e-3,
/// its second moment is sigma_px^2 to 1e-2.
/// Cost    2 additions a pixel, and 80 a block
std::vector<float> wide_blur(std::span<const float> picture, glm::ivec2 size_px, double sigma_px);

/// I from P. `mosaic` as in Radiometry: a Bayer picture's four kinds of pixels are four pictures;
/// "rgb" has its three channels interleaved. To be applied to light in DN/s before it is divided
/// by Maps::response, which is free of veil too.
/// Throws  Error where the picture is not of this size, share not in [0, 0.5).
std::vector<float> remove_veil(std::span<const float> picture,
                               glm::ivec2 size_px,
                               const std::string& mosaic,
                               double share,
                               double sigma_px);
std::vector<float> remove_veil(std::span<const float> picture,
                               glm::ivec2 size_px,
                               const Radiometry& radiometry);

/// Pictures that stand interleaved in one: what a mosaic's colors are.
struct Interleave {
    glm::ivec2 step{1};  // columns and rows from one value to the next of the same plane
    int channels = 1;

    int planes() const { return step.x * step.y * channels; }
    glm::ivec2 size_px(glm::ivec2 whole_px, int plane) const;
    std::vector<float> plane_of(std::span<const float> whole, glm::ivec2 whole_px, int plane) const;
    void put(std::span<const float> plane_values,
             int plane,
             glm::ivec2 whole_px,
             std::span<float> whole) const;
};

Interleave interleave_of(const std::string& mosaic);

}  // namespace nearfield::rig
