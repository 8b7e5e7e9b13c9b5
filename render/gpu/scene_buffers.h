// SPDX-License-Identifier: Apache-2.0
/// A scene's triangles and materials on the graphics card. Scenes do not move: vertices are in the
/// world's frame, transformed in double and rounded once.
#pragma once

#include "formats/scene/scene.h"
#include "render/gpu/device.h"
#include "render/gpu/objects.h"

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace nearfield::render::gpu {

/// An instance's part of the index buffer, and the box that holds it.
struct DrawRange {
    std::uint32_t first_index = 0, indices = 0;
    glm::dvec3 low_world_m{0.0}, high_world_m{0.0};
};

struct SceneBuffers {
    Buffer positions;   // vec4 [vertex]: world, metres; w: 1 + material
    Buffer normals;     // vec4 [vertex]: world, of any length; 0: the triangle's own
    Buffer tangents;    // vec4 [vertex]: world, of any length; 0: none. Only with has_tangents
    Buffer indices;     // uint [3 * triangle], instance by instance
    VertexArray array;  // positions at location 0, and the indices
    std::vector<DrawRange> instances;  // as in Scene
    bool has_tangents = false;         // of a mesh whose material has a lobe
    Buffer materials;                  // MaterialBlock [material] of surface.glsl
    std::size_t geometry_hash = 0;     // of positions and indices

    std::uint32_t index_count() const {
        return instances.empty() ? 0 : instances.back().first_index + instances.back().indices;
    }
};

/// Throws Error where vertices or triangles pass what a shader's buffer may hold on the device.
SceneBuffers upload_scene(Device& device, const Scene& scene);

/// MaterialBlock [material] of surface.glsl alone.
Buffer upload_materials(Device& device, const std::vector<shared::Brdf>& brdfs);

}  // namespace nearfield::render::gpu
