// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace nearfield::report {

/// A gnuplot string in single quotes, where nothing is interpreted.
std::string quoted(const std::string& text);

/// What gnuplot prints for a script; nothing if it is missing or fails.
std::optional<std::string> run_gnuplot(const std::string& script);

}  // namespace nearfield::report
