// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace nearfield {

/// A whole file's bytes. Throws Error if it cannot be read or holds more than `most_bytes`: a slip,
/// such as a movie for a plan, is not read into memory.
std::string read_file(const std::string& path, std::size_t most_bytes = std::size_t{64} << 20);

}  // namespace nearfield
