// SPDX-License-Identifier: Apache-2.0
/// Textures and buffers with storage that does not change its size. All are read by texelFetch or
/// imageLoad: nearest, without mips unless said.
#pragma once

#include "render/gpu/device.h"
#include "render/gpu/objects.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace nearfield::render::gpu {

/// Bytes of one texel of the formats that are used here; 0 for others.
std::size_t bytes_per_texel(GLenum internal_format);

/// All of these throw Error naming `what` with the numbers where it passes the device's limits, and
/// with the bytes where there is no room for it.
Texture make_texture(Device& device,
                     const std::string& what,
                     GLenum internal_format,
                     glm::ivec2 size);
Texture make_texture_array(
    Device& device, const std::string& what, GLenum internal_format, glm::ivec2 size, int layers);

/// A square array with all its mips; side_px: a power of two.
Texture make_mipped_array(
    Device& device, const std::string& what, GLenum internal_format, int side_px, int layers);

/// Fills one level of a layer of an array of four floats a texel: [row][column][channel].
void upload_level(const Texture& array, int level, int side_px, int layer, const float* values);

/// Fills layers first_layer ... of an array of one or two floats a texel (R32F, RG32F, RG16F),
/// values as in memory: [layer][row][column][channel].
void upload_layers(const Texture& array,
                   glm::ivec2 size,
                   int first_layer,
                   int layers,
                   int channels,
                   const float* values);
/// The same for a two-dimensional texture of 1, 2 or 4 channels.
void upload(const Texture& texture, glm::ivec2 size, int channels, const float* values);

/// Values of a two-dimensional float texture: [row][column][channel].
std::vector<float> read_back(const Texture& texture, glm::ivec2 size, int channels);

/// Buffers that shaders read and write.
Buffer make_buffer(Device& device,
                   std::span<const std::byte> data,
                   const std::string& what = "a buffer");
Buffer make_zero_buffer(Device& device, std::size_t bytes, const std::string& what = "a buffer");

template <typename T>
Buffer make_buffer_of(Device& device,
                      const std::vector<T>& values,
                      const std::string& what = "a buffer") {
    return make_buffer(device, std::as_bytes(std::span(values)), what);
}

template <typename T>
std::vector<T> read_buffer(const Buffer& buffer, std::size_t count) {
    std::vector<T> values(count);
    glGetNamedBufferSubData(buffer.id(), 0, static_cast<GLsizeiptr>(count * sizeof(T)),
                            values.data());
    return values;
}

}  // namespace nearfield::render::gpu
