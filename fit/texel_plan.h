// SPDX-License-Identifier: Apache-2.0
/// Which rectangle of S is fitted, and how finely.
#pragma once

#include "fit/rectify.h"
#include "formats/rig/rig.h"

#include <optional>

namespace nearfield::fit {

/// Picture position of a point of S, through the rig's lens; none outside of the picture.
std::optional<glm::dvec2> seen_px(const rig::Rig& rig, glm::dvec2 s_m);

/// Rectangle on S, slab frame.
struct Extent {
    glm::dvec2 min_m{0}, max_m{0};
};

/// A large rectangle along the slab's axes that the camera sees all of.
/// Throws Error if the camera does not see S.
Extent visible_extent(const rig::Rig& rig);

/// The part of `visible` outside of which blocks of 4 x 4 pixels have less than `dark_share` of the
/// brightest one's light, or none that is surer than their noise; a margin of 3 % of its size.
///
/// In   light: [row from the top][column], DN/s; NaN or negative: dark
Extent lit_extent(const rig::Rig& rig,
                  const Extent& visible,
                  std::span<const float> light,
                  double dark_share);

/// Texels as large as a pixel's (of a mosaic: two pixels') mean footprint on the extent, at most
/// `most` along an axis.
glm::ivec2 matching_texels(const rig::Rig& rig, const Extent& extent, int most);

}  // namespace nearfield::fit
