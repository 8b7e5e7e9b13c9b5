// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace nearfield::sample_data {

/// SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
struct SplitMix {
    std::uint64_t state = 0;

    /// Uniform in [0, 1).
    double next() {
        state += 0x9e3779b97f4a7c15ULL;
        std::uint64_t z = state;
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
        z ^= z >> 31U;
        return static_cast<double>(z >> 11U) * 0x1p-53;
    }
};

}  // namespace nearfield::sample_data
