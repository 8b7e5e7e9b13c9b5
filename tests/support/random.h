// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace nearfield::support {

/// splitmix64: the same numbers on every machine and standard library, so that no test needs luck.
struct Random {
    std::uint64_t state = 1;

    std::uint64_t bits() {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31U);
    }
    /// Uniform in [0, 1), a multiple of 2^-53.
    double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
};

}  // namespace nearfield::support
