// SPDX-License-Identifier: Apache-2.0
/// The windowed sum for glossy receivers: f_r times cosine for every texel of S that is in view,
/// shared by all images. No noise; valid where the lobe is wider than a texel.
#pragma once

#include "formats/model/prepared.h"
#include "formats/shared/brdf.glsl.h"
#include "formats/shared/frame.glsl.h"

#include <glm/glm.hpp>

#include <span>

namespace nearfield::model {

/// A point of a surface in the slab's frame, and who looks at it.
struct GlossyReceiver {
    glm::vec3 position_m{0.0F};
    shared::SurfaceFrame frame{};  // of the surface, in the slab's frame; z is its normal
    shared::Brdf brdf{};
    glm::vec3 to_viewer_local{0.0F, 0.0F, 1.0F};  // in the surface's frame
};

/// Whether a sum over texels is right: the lobe (one standard deviation, brdf_lobe_width_rad) is at
/// least as wide as a texel of S seen from the receiver. Where not, as near S itself, sample. True
/// where there is no lobe.
///
/// Error of the lobe's part where windows span 4 texels or more and texels differ by up to ten
/// times from neighbor to neighbor: at the limit 6e-4 (median) and up to 3e-3 (box basis 1e-2),
/// where the lobe is twice as wide 1e-4 and up to 8e-4. Relative to the highlight: what the tails
/// of Ward's and the halfway disk's lobes leave at the surface's horizon is not resolved.
bool texels_resolve_lobe(const Slab& slab, const GlossyReceiver& receiver);

/// Unshadowed irradiance and reflected radiance, R G B.
struct Reflected {
    glm::vec3 irradiance{0.0F};
    glm::vec3 radiance{0.0F};
};

/// The diffuse part is brdf_diffuse / pi times the exact irradiance. The lobe is evaluated at
/// nodes as far apart as it allows, interpolated to the texels by cubics, and multiplied with each
/// image's moments to first order: images differ by what part of a texel they see. image_y, where
/// not empty (one entry an image), gets each image's share of the reflected radiance's Y, in
/// proportion to which shadow rays are drawn.
///
/// Cost    4 to 6 times irradiance() on the reference lamp, for the lobe's weights and its nodes: a
///         few hundred evaluations for a wide lobe, one a texel in view for one as narrow as a
///         texel. GGX whose F0 differs between channels: three times the lobe's part.
Reflected reflect_light(const PreparedSlab& prepared,
                        const GlossyReceiver& receiver,
                        std::span<float> image_y = {});

}  // namespace nearfield::model
