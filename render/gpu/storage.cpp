// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/storage.h"

#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace nearfield::render::gpu {
namespace {

void check_size(const Device& device, const std::string& what, glm::ivec2 size, int layers) {
    const int most = device.max_texture_px();
    if (size.x > most || size.y > most)
        throw Error{"too large for a texture of " + device.renderer(), what,
                    fmt::format("at most {} x {} texels", most, most),
                    fmt::format("{} x {}", size.x, size.y)};
    if (layers > device.max_layers())
        throw Error{"too many images for a texture of " + device.renderer(), what,
                    fmt::format("at most {} layers", device.max_layers()),
                    fmt::format("{}", layers)};
}

void set_nearest(GLuint id) {
    glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTextureParameteri(id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

std::uint64_t bytes_of(GLenum internal_format, glm::ivec2 size, int layers) {
    return bytes_per_texel(internal_format) * static_cast<std::uint64_t>(size.x) *
           static_cast<std::uint64_t>(size.y) * static_cast<std::uint64_t>(layers);
}

/// Storage for `bytes`, without content.
Buffer make_storage(Device& device, std::size_t bytes, const std::string& what) {
    if (bytes > device.max_buffer_bytes())
        throw Error{"too large for a buffer of " + device.renderer(), what,
                    fmt::format("at most {} bytes", device.max_buffer_bytes()),
                    fmt::format("{}", bytes)};
    device.check_room(what, bytes);
    GLuint id = 0;
    glCreateBuffers(1, &id);
    Buffer buffer(id);
    glNamedBufferStorage(id, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_STORAGE_BIT);
    device.check_allocation(what, bytes);
    device.count_allocation(bytes);
    return buffer;
}

GLenum format_of(int channels) {
    return channels == 1 ? GL_RED : channels == 2 ? GL_RG : GL_RGBA;
}

}  // namespace

std::size_t bytes_per_texel(GLenum internal_format) {
    switch (internal_format) {
        case GL_R8:
            return 1;
        case GL_R32F:
        case GL_R32UI:
        case GL_RG16F:
        case GL_RGBA8:
        case GL_DEPTH_COMPONENT32F:
            return 4;
        case GL_RG32F:
        case GL_RGBA16F:
            return 8;
        case GL_RGBA32F:
            return 16;
        default:
            return 0;
    }
}

Texture make_texture(Device& device,
                     const std::string& what,
                     GLenum internal_format,
                     glm::ivec2 size) {
    check_size(device, what, size, 1);
    const std::uint64_t bytes = bytes_of(internal_format, size, 1);
    device.check_room(what, bytes);
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &id);
    Texture texture(id);
    glTextureStorage2D(id, 1, internal_format, size.x, size.y);
    device.check_allocation(what, bytes);
    set_nearest(id);
    device.count_allocation(bytes);
    return texture;
}

Texture make_texture_array(
    Device& device, const std::string& what, GLenum internal_format, glm::ivec2 size, int layers) {
    check_size(device, what, size, layers);
    const std::uint64_t bytes = bytes_of(internal_format, size, layers);
    device.check_room(what, bytes);
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
    Texture texture(id);
    glTextureStorage3D(id, 1, internal_format, size.x, size.y, layers);
    device.check_allocation(what, bytes);
    set_nearest(id);
    device.count_allocation(bytes);
    return texture;
}

Texture make_mipped_array(
    Device& device, const std::string& what, GLenum internal_format, int side_px, int layers) {
    check_size(device, what, glm::ivec2(side_px), layers);
    std::uint64_t bytes = 0;
    int levels = 0;
    for (int side = side_px; side > 0; side /= 2, ++levels)
        bytes += bytes_of(internal_format, glm::ivec2(side), layers);
    device.check_room(what, bytes);
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
    Texture texture(id);
    glTextureStorage3D(id, levels, internal_format, side_px, side_px, layers);
    device.check_allocation(what, bytes);
    set_nearest(id);
    glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
    device.count_allocation(bytes);
    return texture;
}

void upload_level(const Texture& array, int level, int side_px, int layer, const float* values) {
    glTextureSubImage3D(array.id(), level, 0, 0, layer, side_px, side_px, 1, GL_RGBA, GL_FLOAT,
                        values);
}

void upload_layers(const Texture& array,
                   glm::ivec2 size,
                   int first_layer,
                   int layers,
                   int channels,
                   const float* values) {
    glTextureSubImage3D(array.id(), 0, 0, 0, first_layer, size.x, size.y, layers,
                        format_of(channels), GL_FLOAT, values);
}

void upload(const Texture& texture, glm::ivec2 size, int channels, const float* values) {
    glTextureSubImage2D(texture.id(), 0, 0, 0, size.x, size.y, format_of(channels), GL_FLOAT,
                        values);
}

std::vector<float> read_back(const Texture& texture, glm::ivec2 size, int channels) {
    std::vector<float> values(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                              static_cast<std::size_t>(channels));
    glGetTextureImage(texture.id(), 0, format_of(channels), GL_FLOAT,
                      static_cast<GLsizei>(values.size() * sizeof(float)), values.data());
    return values;
}

Buffer make_buffer(Device& device, std::span<const std::byte> data, const std::string& what) {
    // No buffer is empty: drivers refuse those.
    Buffer buffer = make_storage(device, std::max<std::size_t>(data.size(), 16), what);
    if (!data.empty())
        glNamedBufferSubData(buffer.id(), 0, static_cast<GLsizeiptr>(data.size()), data.data());
    return buffer;
}

Buffer make_zero_buffer(Device& device, std::size_t bytes, const std::string& what) {
    Buffer buffer = make_storage(device, bytes, what);
    glClearNamedBufferData(buffer.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    return buffer;
}

}  // namespace nearfield::render::gpu
