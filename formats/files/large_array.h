// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace nearfield {

/// Resizes an empty array of which all will be used soon. Large ones ask for huge pages: touching
/// 75 MiB for the first time takes 19,000 page faults of 4 KiB, longer than filling it.
template <typename Value>
void resize_large(std::vector<Value>& values, std::size_t count) {
    constexpr std::uintptr_t kHugePage = 2U << 20U;
    values.reserve(count);
    const auto begin = reinterpret_cast<std::uintptr_t>(values.data());
    const std::uintptr_t first = (begin + kHugePage - 1) / kHugePage * kHugePage;
    const std::uintptr_t end = (begin + count * sizeof(Value)) / kHugePage * kHugePage;
    // Advice: where it is not taken, nothing but time is lost.
    if (end > first)
        madvise(reinterpret_cast<char*>(values.data()) + (first - begin), end - first,
                MADV_HUGEPAGE);
    values.resize(count);
}

}  // namespace nearfield
