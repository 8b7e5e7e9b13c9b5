// SPDX-License-Identifier: Apache-2.0
/// Shares of light that filter and plate let through, averaged over a small area.
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

namespace nearfield::sample_data {

/// The profile at x, or its mean over [x - width/2, x + width/2]; in pitches.
double mean_transmission(const Profile& profile, double x, double width);

/// Share of a rectangle that lies in the disk of this radius about the origin. Closed form.
double disk_share(glm::dvec2 center_m, glm::dvec2 size_m, double radius_m);

}  // namespace nearfield::sample_data
