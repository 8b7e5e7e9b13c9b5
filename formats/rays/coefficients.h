// SPDX-License-Identifier: Apache-2.0
/// From the flux of texels and its shares among basis functions to a slab's coefficients.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/rays/directions.h"
#include "formats/rays/planes.h"
#include "formats/rays/texel_flux.h"

#include <glm/glm.hpp>

#include <vector>

namespace nearfield::rays {

/// The slab's geometry, without coefficients; the first slab's S is the luminaire's z = 0.
Slab make_slab(const Planes& planes,
               const Planes& first,
               const Aperture& aperture,
               const TexelGrid& texels);

/// Sets channels, coefficients and sigma. `fits`: shares among basis functions, coarse blocks
/// first; `colors`: of the rays, as RaySet has them; none: one channel.
void fill(Slab& slab,
          const TexelGrid& grid,
          const TexelFlux& flux,
          const std::vector<BlockShares>& fits,
          const std::vector<glm::vec3>& colors);

}  // namespace nearfield::rays
