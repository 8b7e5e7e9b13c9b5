// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace nearfield::rays {

/// The numbers of a line, with blanks, tabs or commas between them; nothing where anything else
/// stands there. Infinity and NaN by name are numbers here: who reads them refuses them.
std::optional<std::vector<double>> numbers_of(std::string_view line);

/// The same without memory of its own: how many there are, at most `most` of them stored; -1: not
/// numbers alone.
int parse_numbers(std::string_view line, float* numbers, int most);

}  // namespace nearfield::rays
