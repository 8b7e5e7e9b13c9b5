// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nearfield::render {

constexpr int kMaxExtentPx = 16384;

/// What this process may still allocate without pushing others out: the least of the machine's
/// available memory and of the process' own limit (ulimit -v). Infinite where neither is known.
double available_memory_bytes();

}  // namespace nearfield::render
