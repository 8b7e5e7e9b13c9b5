// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <glm/glm.hpp>

#include <cstdio>
#include <string>

namespace nearfield::app {

/// "11x9" as two numbers. What does not parse is a usage error.
inline glm::ivec2 parse_size(const std::string& text, const std::string& option) {
    glm::ivec2 size(0);
    int end = 0;
    if (std::sscanf(text.c_str(), "%4dx%4d%n", &size.x, &size.y, &end) != 2 ||
        static_cast<std::size_t>(end) != text.size() || size.x < 1 || size.y < 1) {
        throw CLI::ValidationError(option, "expected WIDTHxHEIGHT, each 1 ... 9999, got " + text);
    }
    return size;
}

}  // namespace nearfield::app
