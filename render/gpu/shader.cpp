// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/shader.h"

#include "formats/files/error.h"
#include "render/gpu/shader_sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace nearfield::render::gpu {
namespace {

std::string_view source_of(const std::string& path, const std::string& included_from) {
    for (const ShaderSource& source : shader_sources())
        if (source.path == path)
            return source.text;
    throw Error{"no such shader", included_from, "an embedded source", path};
}

/// The path in `#include "path"`; empty for any other line, and for <path>.
std::string quoted_include(std::string_view line) {
    const std::size_t hash = line.find_first_not_of(" \t");
    if (hash == std::string_view::npos || !line.substr(hash).starts_with("#include"))
        return {};
    const std::size_t open = line.find('"'), close = line.rfind('"');
    return open == close ? std::string() : std::string(line.substr(open + 1, close - open - 1));
}

bool is_include(std::string_view line) {
    const std::size_t hash = line.find_first_not_of(" \t");
    return hash != std::string_view::npos && line.substr(hash).starts_with("#include");
}

void append(const std::string& path, const std::string& included_from, ResolvedShader& shader) {
    if (std::find(shader.files.begin(), shader.files.end(), path) != shader.files.end())
        return;
    const std::size_t number = shader.files.size();
    shader.files.push_back(path);
    shader.text += fmt::format("#line 1 {}\n", number);
    std::string_view rest = source_of(path, included_from);
    for (int line_number = 1; !rest.empty(); ++line_number) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        const std::string_view line = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (!is_include(line)) {
            shader.text.append(line).append("\n");
            continue;
        }
        if (const std::string included = quoted_include(line); !included.empty())
            append(included, fmt::format("{}:{}", path, line_number), shader);
        shader.text += fmt::format("#line {} {}\n", line_number + 1, number);
    }
}

/// A driver's "2:17(5): error: ..." (Mesa) or "2(17) : error ..." (NVIDIA) with the file's path in
/// place of its number.
std::string with_paths(std::string log, const std::vector<std::string>& files) {
    while (!log.empty() && (log.back() == '\n' || log.back() == '\0'))
        log.pop_back();
    std::size_t file = 0;
    const auto [end, failed] = std::from_chars(log.data(), log.data() + log.size(), file);
    const auto digits = static_cast<std::size_t>(end - log.data());
    if (failed != std::errc() || file >= files.size() || digits == log.size())
        return log;
    return files[file] + log.substr(digits);
}

Shader compile(GLenum stage, const std::string& path, const Defines& defines) {
    const ResolvedShader resolved = resolve(path, defines);
    Shader shader(glCreateShader(stage));
    const char* text = resolved.text.c_str();
    glShaderSource(shader.id(), 1, &text, nullptr);
    glCompileShader(shader.id());
    GLint is_compiled = 0;
    glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &is_compiled);
    if (is_compiled == GL_TRUE)
        return shader;
    std::string log(8192, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw Error{"a shader does not compile", path, "", with_paths(log, resolved.files)};
}

Program link(const std::string& name, const std::vector<Shader>& shaders) {
    Program program(glCreateProgram());
    for (const Shader& shader : shaders)
        glAttachShader(program.id(), shader.id());
    glLinkProgram(program.id());
    GLint is_linked = 0;
    glGetProgramiv(program.id(), GL_LINK_STATUS, &is_linked);
    if (is_linked == GL_TRUE)
        return program;
    std::string log(8192, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program.id(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw Error{"shaders do not link", name, "", log};
}

}  // namespace

ResolvedShader resolve(const std::string& path, const Defines& defines) {
    ResolvedShader shader;
    shader.text = "#version 450 core\n";
    for (const std::string& define : defines)
        shader.text += "#define " + define + "\n";
    append(path, "the program", shader);
    return shader;
}

Program link_compute(const std::string& path, const Defines& defines) {
    std::vector<Shader> shaders;
    shaders.push_back(compile(GL_COMPUTE_SHADER, path, defines));
    return link(path, shaders);
}

Program link_draw(const std::string& vertex_path,
                  const std::string& fragment_path,
                  const Defines& defines) {
    std::vector<Shader> shaders;
    shaders.push_back(compile(GL_VERTEX_SHADER, vertex_path, defines));
    shaders.push_back(compile(GL_FRAGMENT_SHADER, fragment_path, defines));
    return link(vertex_path + ", " + fragment_path, shaders);
}

void dispatch_2d(const Program& program, int width, int height) {
    constexpr int kGroup = 8;
    glUseProgram(program.id());
    glDispatchCompute(static_cast<GLuint>((width + kGroup - 1) / kGroup),
                      static_cast<GLuint>((height + kGroup - 1) / kGroup), 1);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                    GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                    GL_BUFFER_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

}  // namespace nearfield::render::gpu
