// SPDX-License-Identifier: Apache-2.0
/// What a ray file holds, without keeping its rays: memory does not grow with the file.
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nearfield::rays {

/// Of all rays, in the file's frame.
struct RaySurvey {
    std::string format;
    Quantity quantity = Quantity::Photometric;
    std::uint64_t rays = 0;
    double flux = 0;         // sum as the file holds it, lm or W
    double flux_stated = 0;  // by the header, in the same quantity; 0: not
    glm::dvec3 least_start_m{0.0}, most_start_m{0.0};
    std::uint64_t backward_rays = 0;  // towards -z
    double backward_flux = 0;
    /// The virtual focus: the point with the least flux-weighted sum of squared distances from the
    /// rays' lines. Nothing where all rays are parallel.
    std::optional<glm::dvec3> focus_m;
    std::vector<std::string> notes;
};

/// Throws Error naming the byte as RayFile does. Cost: one pass.
RaySurvey survey_rays(const std::string& path, bool keep_radiometric);

}  // namespace nearfield::rays
