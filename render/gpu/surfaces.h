// SPDX-License-Identifier: Apache-2.0
/// What the camera sees at every pixel: render/shaders/surface.glsl's view of the scene.
///
/// Triangles are rasterized by their numbers alone; then each pixel's ray meets its triangle's
/// plane again in double, as render/cpu/tracer.cpp does, so that positions do not suffer from the
/// rasterizer's snapping of vertices to 1/256 of a pixel. They agree with the CPU's to the rounding
/// of float. At triangles' borders the two may see different triangles.
#pragma once

#include "formats/scene/scene.h"
#include "render/gpu/device.h"
#include "render/gpu/objects.h"
#include "render/gpu/scene_buffers.h"
#include "render/gpu/shader.h"

#include <glm/glm.hpp>

#include <span>

namespace nearfield::render::gpu {

struct Surfaces {
    glm::ivec2 size_px{0};
    bool has_tangents = false;  // else shaders are compiled without HAS_TANGENTS
    Texture position;           // RGBA32F: world, metres; 1 + material, 0: nothing is seen
    Texture normal;   // RGBA32F: world, unit length, towards the viewer (where nothing is seen: the
                      // ray's direction); depth along the camera's axis, metres
    Texture tangent;  // RGBA32F: world, of any length; only with has_tangents
    bool has_turns = false;
    Texture turn;  // R32F: how far the normal turns across a pixel, radians; only with has_turns
    Buffer frame;  // FrameBlock
};

/// A pixel of surfaces that are not drawn but known.
struct SurfacePoint {
    glm::vec3 position_world_m{0.0F};
    glm::vec3 normal{0.0F, 0.0F, 1.0F};  // unit length, towards the viewer
    glm::vec3 tangent{0.0F};             // of any length; 0: none
    int material = -1;                   // -1: nothing is seen
    float depth_m = 0.0F;
};

/// points: [row from the top][column].
Surfaces upload_surfaces(Device& device,
                         glm::ivec2 size_px,
                         std::span<const SurfacePoint> points,
                         glm::dvec3 eye_world_m,
                         bool has_tangents);

/// What draw_surfaces() needs from one frame to the next: programs, and targets of one size.
struct SurfacePass {
    glm::ivec2 size_px{0};
    bool has_tangents = false;
    Program draw, resolve;
    Texture triangle, depth;  // R32UI: 1 + triangle, 0: none; reversed depth
    Framebuffer framebuffer;
    Surfaces surfaces;  // the last that was drawn
};

/// has_turns: whether Surfaces::turn is wanted.
SurfacePass make_surface_pass(Device& device,
                              const SceneBuffers& scene,
                              glm::ivec2 size_px,
                              bool has_turns = false);

/// Fills pass.surfaces with what the camera sees, a ray a pixel through `at_px` of it (0.5, 0.5:
/// the middle; x right, y down). Surfaces have two sides. Changes the bound framebuffer, program,
/// viewport, image units 0 to 3 and storage buffers 4 to 7; depth test and clip control are put
/// back to OpenGL's defaults.
void draw_surfaces(const SceneBuffers& scene,
                   const Camera& camera,
                   glm::dvec2 at_px,
                   const SurfacePass& pass);

/// Binds both where surface.glsl expects them.
void bind_surfaces(const Surfaces& surfaces, const Buffer& materials);

}  // namespace nearfield::render::gpu
