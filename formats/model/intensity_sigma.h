// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

namespace nearfield::model {

/// Standard deviation of the far-field intensity's Y (luminaire.h) from the spread of replicates,
/// else from the coefficients' sigma as if independent, and the common scale's. The direction is in
/// the luminaire's frame and need not be of unit length.
double intensity_sigma_y(const LightField& lightfield, glm::dvec3 direction);

}  // namespace nearfield::model
