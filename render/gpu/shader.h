// SPDX-License-Identifier: Apache-2.0
/// Programs from the embedded sources.
#pragma once

#include "render/gpu/objects.h"

#include <string>
#include <vector>

namespace nearfield::render::gpu {

/// "NAME VALUE" lines put before a shader: what makes its variants.
using Defines = std::vector<std::string>;

/// A shader's whole text: #version, defines, and its #includes in place, each file once (as with
/// #pragma once), with #line so that messages name the file's own lines. Includes in <> are C++'s
/// and left out. files: paths by the number that #line gives them.
struct ResolvedShader {
    std::string text;
    std::vector<std::string> files;
};
/// Throws Error where a file is not among the embedded ones.
ResolvedShader resolve(const std::string& path, const Defines& defines = {});

/// Throws Error with file and line where a shader does not compile or link.
Program link_compute(const std::string& path, const Defines& defines = {});
Program link_draw(const std::string& vertex_path,
                  const std::string& fragment_path,
                  const Defines& defines = {});

/// Runs a program whose groups are 8 x 8 over width x height invocations, and makes what it wrote
/// visible to what comes next.
void dispatch_2d(const Program& program, int width, int height);

}  // namespace nearfield::render::gpu
