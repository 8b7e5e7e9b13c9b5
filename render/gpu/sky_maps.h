// SPDX-License-Identifier: Apache-2.0
/// Shadow maps of an environment's few directions, without perspective: what
/// render/shaders/sky_maps.glsl reads.
///
/// A map shows all of the scene: its texel is the scene's extent across the direction over map_px.
/// A receiver is compared with the plane through it; less than 1.5 widths of a texel before that
/// nothing casts a shadow. Triangles have two sides.
#pragma once

#include "render/gpu/device.h"
#include "render/gpu/objects.h"
#include "render/gpu/scene_buffers.h"
#include "render/gpu/shader.h"
#include "render/sky.h"

#include <glm/glm.hpp>

#include <cstddef>
#include <memory>
#include <span>

namespace nearfield::render::gpu {

/// What maps were rendered for.
struct SkyMapKey {
    std::shared_ptr<const environment::Environment> environment;
    glm::mat3 environment_from_world{1.0F};
    std::size_t geometry_hash = 0;
    int map_px = 0;

    bool operator==(const SkyMapKey&) const = default;
};

struct SkyMaps {
    Texture depth;  // DEPTH_COMPONENT32F array [direction], map_px a side
    Buffer views;   // mat4 [direction]
    SkyMapKey key;
    int renders = 0;  // how often they were rendered
};

struct SkyMapPass {
    Program draw;
    Framebuffer framebuffer;
};
SkyMapPass make_sky_map_pass();

/// World to a map: x, y in -1 ... 1 hold the boxes' corners, z is 0 ... 1 towards the light.
/// direction: of unit length, world.
glm::dmat4 clip_from_world(glm::dvec3 direction, std::span<const DrawRange> instances);

/// Renders the maps unless they are already of this environment, turned so, and of this scene:
/// geometry may change from frame to frame. Changes the bound framebuffer, program and viewport.
void update_sky_maps(Device& device,
                     const SkyMapPass& pass,
                     const SceneBuffers& scene,
                     const Sky& sky,
                     int map_px,
                     SkyMaps& maps);

/// Binds them where sky_maps.glsl expects them.
void bind_sky_maps(const SkyMaps& maps);

}  // namespace nearfield::render::gpu
