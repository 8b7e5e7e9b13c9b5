// SPDX-License-Identifier: Apache-2.0
/// Text in a kernel structure's field of fixed size.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nearfield::devices {

/// Cuts what is too long, fills up with zeros. By pointer, since the kernel packs some structures.
inline void put_text(std::uint8_t* to, std::size_t bytes, std::string_view text) {
    std::fill_n(to, bytes, std::uint8_t{0});
    std::copy_n(text.begin(), std::min(text.size(), bytes - 1), to);
}

}  // namespace nearfield::devices
