// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/image.h"
#include "render/opening.h"
#include "render/options.h"

#include <cstddef>
#include <optional>

namespace nearfield::render {

/// The layer that add_seen_lamps() adds.
constexpr const char* kSeenLamps = "lamps";

/// Lamps themselves, where the camera looks into them: adds to the picture, which is complete, the
/// radiance that leaves their U planes towards the eye, as the light field has it, at the middles
/// of the pixels' strata; to the default layer, and as a layer "lamps" (R, G, B). What a lamp has
/// of its own, "lamp.NAME", stays the light of surfaces. Both renderers end with it, so that it is
/// the same on either. Nothing but that where no lamp is turned to the camera. only: of the lamps,
/// one.
///
/// Surfaces of the picture's depth hide it; those that the lamp's own light passes (excludes) too.
/// It is not reflected, and its pixels have no sigma of their own.
///
/// Cost     a pixel of the rectangle that a lamp covers: 20 to 200 ns a stratum.
void add_seen_lamps(const Opening& opening,
                    const RenderOptions& options,
                    std::optional<std::size_t> only,
                    Picture& picture);

}  // namespace nearfield::render
