// SPDX-License-Identifier: Apache-2.0
/// Random numbers of replicates: a hash of seed, replicate, channel, texel and measurement.
#pragma once

#include "formats/shared/rng.glsl.h"

#include <glm/glm.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace nearfield::fit {

/// What all numbers of a texel's replicate have in common.
using NoiseKey = glm::uvec4;

inline NoiseKey noise_key(std::uint64_t seed,
                          std::uint32_t replicate,
                          std::uint32_t channel,
                          std::size_t texel) {
    const auto low = static_cast<std::uint32_t>(seed);
    const auto high = static_cast<std::uint32_t>(seed >> 32U);
    const glm::uvec4 key = shared::hash4(glm::uvec4(low, high, replicate, channel));
    return {key.x, key.y, key.z ^ static_cast<std::uint32_t>(texel),
            key.w ^ static_cast<std::uint32_t>(texel >> 32U)};
}

/// Standard normal (Box and Muller, 1958), |z| < 6.7.
inline double normal_number(NoiseKey key, std::uint32_t index) {
    const glm::uvec4 words = shared::hash4(glm::uvec4(key.x ^ index, key.y, key.z, key.w));
    const double u = (static_cast<double>(words.x) + 0.5) * 0x1p-32;
    const double angle = 6.283185307179586 * (static_cast<double>(words.y) + 0.5) * 0x1p-32;
    return std::sqrt(-2.0 * std::log(u)) * std::cos(angle);
}

}  // namespace nearfield::fit
