// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace nearfield::test {

/// The largest piece of memory that operator new gave since reset. Always 0 under AddressSanitizer,
/// which brings its own operator new (ASAN_OPTIONS=max_allocation_size_mb limits it there).
std::size_t largest_allocation();
void reset_largest_allocation();

}  // namespace nearfield::test
