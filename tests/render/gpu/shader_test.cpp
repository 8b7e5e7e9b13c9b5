// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/shader.h"

#include "formats/files/error.h"
#include "render/gpu/shader_sources.h"
#include "tests/render/gpu/gl_fixture.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

namespace nearfield::render::gpu {
namespace {

class ShaderTest : public GlTest {};

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

TEST(ResolvedShader, HoldsEachFileOnceInPlace) {
    const ResolvedShader shader = resolve("render/shaders/slab.glsl", {"HAS_COLOR"});
    EXPECT_THAT(shader.text, testing::StartsWith("#version 450 core\n#define HAS_COLOR\n"));
    EXPECT_EQ(count_of(shader.text, "struct AxisView {"), 1U);  // window.glsl.h has no guard
    EXPECT_EQ(count_of(shader.text, "#include"), 0U);
    EXPECT_EQ(shader.files.front(), "render/shaders/slab.glsl");
}

TEST(ResolvedShader, NamesWhoIncludesAMissingFile) {
    try {
        resolve("render/shaders/none.comp");
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.got, "render/shaders/none.comp");
    }
}

TEST_F(ShaderTest, SaysFileAndLineOfWhatDoesNotCompile) {
    try {
        // A type that the shared header uses, turned into nonsense.
        link_compute("render/shaders/slab.glsl", {"AxisView 7"});
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_THAT(error.got, testing::HasSubstr("formats/shared/window.glsl.h:")) << error.got;
    }
}

// Every shader is valid for a second compiler too, which is stricter than Mesa's.
TEST(Shaders, PassTheReferenceCompiler) {
    int checked = 0;
    for (const ShaderSource& source : shader_sources()) {
        const std::string path(source.path);
        const std::string stage = path.substr(path.rfind('.') + 1);
        if (stage != "comp" && stage != "vert" && stage != "frag")
            continue;
        for (const Defines& variant :
             {Defines{}, Defines{"HAS_COLOR", "HAS_SHADOWS", "HAS_GLOSS"}}) {
            std::ofstream("resolved." + stage) << resolve(path, variant).text;
            const std::string command = "glslangValidator resolved." + stage + " > glslang.log";
            // One thread: nothing else runs beside a test.
            const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe)
            EXPECT_EQ(status, 0) << path << ":\n" << std::ifstream("glslang.log").rdbuf();
        }
        ++checked;
    }
    EXPECT_GT(checked, 0);
}

}  // namespace
}  // namespace nearfield::render::gpu
