// SPDX-License-Identifier: Apache-2.0
#include "tests/files/allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> largest{0};
}

#ifndef __SANITIZE_ADDRESS__
void* operator new(std::size_t size) {
    std::size_t before = largest;
    while (size > before && !largest.compare_exchange_weak(before, size)) {
    }
    if (void* memory = std::malloc(size))
        return memory;
    throw std::bad_alloc{};
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
#endif

namespace nearfield::test {

std::size_t largest_allocation() {
    return largest;
}
void reset_largest_allocation() {
    largest = 0;
}

}  // namespace nearfield::test
