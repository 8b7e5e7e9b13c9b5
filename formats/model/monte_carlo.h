// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/model/luminaire.h"

#include <cstdint>

namespace nearfield::model {

/// An estimate and the standard deviation of its Y that sampling makes.
struct Estimate {
    glm::dvec3 value{0.0};
    double sigma_y = 0;
};

/// Unshadowed irradiance by plain Monte Carlo from the definition: rays through points uniform on
/// U's support, each carrying L(u -> s): slow and noisy, and independent of the windowed sum that
/// it checks.
///
/// samples   per slab, at least 2
/// stream    which random numbers: equal seed and stream give equal results, different streams
/// independent ones
Estimate irradiance_by_sampling(const LightField& lightfield,
                                const Receiver& receiver,
                                std::uint32_t samples,
                                std::uint32_t seed,
                                std::uint32_t stream);

}  // namespace nearfield::model
