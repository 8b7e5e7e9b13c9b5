// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/objects.h"

namespace nearfield::render::gpu {

void delete_object(Kind kind, GLuint id) {
    if (id == 0)
        return;
    switch (kind) {
        case Kind::Texture:
            return glDeleteTextures(1, &id);
        case Kind::Buffer:
            return glDeleteBuffers(1, &id);
        case Kind::Framebuffer:
            return glDeleteFramebuffers(1, &id);
        case Kind::VertexArray:
            return glDeleteVertexArrays(1, &id);
        case Kind::Program:
            return glDeleteProgram(id);
        case Kind::Shader:
            return glDeleteShader(id);
        case Kind::Query:
            return glDeleteQueries(1, &id);
    }
}

}  // namespace nearfield::render::gpu
