// SPDX-License-Identifier: Apache-2.0
#include "formats/model/monte_carlo.h"

#include "formats/shared/philox.glsl.h"

#include <cmath>

namespace nearfield::model {
namespace {

// E = int over U of L cos_receiver cos_U / R^2 du, with du's density 1 / area.
Estimate sample_slab(const Slab& slab,
                     const Receiver& receiver,
                     std::uint32_t samples,
                     glm::uvec2 counter,
                     std::uint32_t seed) {
    const glm::dvec3 p = receiver.position_m;
    const double height = p.z + slab.delta_m;
    if (!(height > 0.0))
        return {};
    const glm::dvec2 extent =
        (glm::dvec2(slab.grid - 1) + static_cast<double>(slab.profile.cells.size())) * slab.pitch_m;
    const glm::dvec2 corner = slab.u_center_m - 0.5 * extent;
    Estimate estimate;
    double sum_of_squares = 0.0;
    for (std::uint32_t k = 0; k < samples; ++k) {
        const glm::uvec4 bits = shared::philox4x32({k, counter, 0U}, {seed, 0U});
        const glm::dvec2 u = corner + extent * glm::dvec2(bits.x * 0x1p-32, bits.y * 0x1p-32);
        const glm::dvec2 s = u + (glm::dvec2(p) - u) * (slab.delta_m / height);
        const glm::dvec3 to_u = glm::dvec3(u, -slab.delta_m) - p;
        const double r2 = glm::dot(to_u, to_u);
        const double cosine = glm::dot(receiver.normal, to_u);
        if (!(cosine > 0.0))
            continue;
        const glm::dvec3 value =
            radiance(slab, u, s) * (cosine * height / (r2 * r2) * extent.x * extent.y);
        estimate.value += value;
        sum_of_squares += luminance(value) * luminance(value);
    }
    const double n = samples;
    estimate.value /= n;
    const double mean = luminance(estimate.value);
    estimate.sigma_y = std::sqrt(std::max(sum_of_squares / n - mean * mean, 0.0) / (n - 1.0));
    return estimate;
}

}  // namespace

Estimate irradiance_by_sampling(const LightField& lightfield,
                                const Receiver& receiver,
                                std::uint32_t samples,
                                std::uint32_t seed,
                                std::uint32_t stream) {
    Estimate total;
    double variance = 0.0;
    std::uint32_t index = 0;
    for (const Slab& slab : lightfield.slabs) {
        const Estimate estimate =
            sample_slab(slab, to_slab(slab, receiver), samples, {stream, index++}, seed);
        total.value += estimate.value;
        variance += estimate.sigma_y * estimate.sigma_y;
    }
    total.sigma_y = std::sqrt(variance);
    return total;
}

}  // namespace nearfield::model
