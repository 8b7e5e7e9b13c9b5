// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace nearfield::render::gpu {

struct ShaderSource {
    std::string_view path;  // from the project's root, as #include names it
    std::string_view text;
};

/// All shaders and the headers that they share with C++, as they were when the program was built.
std::span<const ShaderSource> shader_sources();

}  // namespace nearfield::render::gpu
