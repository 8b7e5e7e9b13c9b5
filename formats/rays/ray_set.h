// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/lightfield.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace nearfield::rays {

/// One sample of a lamp's light in the ray file's frame: `flux` travels through `position_m` along
/// `direction`.
struct Ray {
    glm::vec3 position_m{0.0F};
    glm::vec3 direction{0.0F, 0.0F, 1.0F};  // unit length
    float flux = 0.0F;                      // lm or W, >= 0
};

/// A lamp as a list of rays.
struct RaySet {
    std::string format;  // of the file: "IES TM-25", "Zemax" ...
    Quantity quantity = Quantity::Photometric;
    std::vector<Ray> rays;
    /// Linear Rec.709 of each ray per unit of flux: Y = 1, every channel >= 0. Empty: unknown; one:
    /// shared by all.
    std::vector<glm::vec3> colors;
    double flux_of_rays = 0;      // sum as the file holds it, before scaling; in `quantity`'s unit
    double flux_stated = 0;       // what the header says; 0: nothing
    std::size_t desaturated = 0;  // colors out of Rec.709's gamut, moved towards white at equal Y
    std::vector<std::string> notes;  // what a user should know about the file, one sentence each
};

/// Sum of the rays' flux.
double flux(const RaySet& set);

}  // namespace nearfield::rays
