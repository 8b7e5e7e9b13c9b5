// SPDX-License-Identifier: Apache-2.0
/// Big-endian numbers in datagrams and registers: most significant byte first, as GigE Vision has
/// them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace nearfield::gige {

inline void put_u16(std::uint8_t* to, std::uint32_t value) {
    to[0] = static_cast<std::uint8_t>(value >> 8U);
    to[1] = static_cast<std::uint8_t>(value);
}

inline void put_u32(std::uint8_t* to, std::uint32_t value) {
    put_u16(to, value >> 16U);
    put_u16(to + 2, value);
}

inline void put_u64(std::uint8_t* to, std::uint64_t value) {
    put_u32(to, static_cast<std::uint32_t>(value >> 32U));
    put_u32(to + 4, static_cast<std::uint32_t>(value));
}

inline std::uint32_t u16_at(std::span<const std::uint8_t> bytes, std::size_t at) {
    return static_cast<std::uint32_t>(bytes[at] << 8U | bytes[at + 1]);
}

inline std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t at) {
    return u16_at(bytes, at) << 16U | u16_at(bytes, at + 2);
}

inline std::uint64_t u64_at(std::span<const std::uint8_t> bytes, std::size_t at) {
    return std::uint64_t{u32_at(bytes, at)} << 32U | u32_at(bytes, at + 4);
}

inline double f64_at(std::span<const std::uint8_t> bytes, std::size_t at) {
    return std::bit_cast<double>(u64_at(bytes, at));
}

}  // namespace nearfield::gige
