// SPDX-License-Identifier: Apache-2.0
/// OpenGL's objects as values that delete what they own. They must not outlive the context.
#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace nearfield::render::gpu {

enum class Kind { Texture, Buffer, Framebuffer, VertexArray, Program, Shader, Query };

/// Deletes an object; 0 is none.
void delete_object(Kind kind, GLuint id);

template <Kind kKind>
class Object {
  public:
    Object() = default;
    explicit Object(GLuint id) : id_(id) {}
    ~Object() { delete_object(kKind, id_); }
    Object(Object&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    Object& operator=(Object&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;

    GLuint id() const { return id_; }
    explicit operator bool() const { return id_ != 0; }

  private:
    GLuint id_ = 0;
};

using Texture = Object<Kind::Texture>;
using Buffer = Object<Kind::Buffer>;
using Framebuffer = Object<Kind::Framebuffer>;
using VertexArray = Object<Kind::VertexArray>;
using Program = Object<Kind::Program>;
using Shader = Object<Kind::Shader>;
using Query = Object<Kind::Query>;

}  // namespace nearfield::render::gpu
