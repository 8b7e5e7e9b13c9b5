// SPDX-License-Identifier: Apache-2.0
/// Numbers as USB has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::devices {

inline void append(std::vector<std::uint8_t>& to, std::uint64_t value, std::size_t bytes) {
    for (std::size_t k = 0; k < bytes; ++k)
        to.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

inline std::uint64_t number_at(std::span<const std::uint8_t> bytes,
                               std::size_t at,
                               std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < count; ++k)
        value |= std::uint64_t{bytes[at + k]} << (8 * k);
    return value;
}

}  // namespace nearfield::devices
