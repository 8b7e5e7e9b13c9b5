// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/scene_buffers.h"

#include "render/gpu/storage.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <span>
#include <string_view>

namespace nearfield::render::gpu {
namespace {

// As std430 lays MaterialBlock of surface.glsl out.
struct MaterialBlock {
    glm::vec4 diffuse_exponent, specular_kind, alpha, cosines;
};
static_assert(sizeof(MaterialBlock) == 64);

struct Vertices {
    std::vector<glm::vec4> positions, normals, tangents;
    std::vector<std::uint32_t> indices;
};

bool needs_tangents(const Scene& scene) {
    return std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& one) {
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(one.mesh)];
        return !mesh.tangents.empty() &&
               shared::brdf_is_glossy(
                   brdf(scene.materials[static_cast<std::size_t>(mesh.material)]));
    });
}

/// `count` vectors, turned; none: zeros.
void append_turned(const std::vector<glm::vec3>& vectors,
                   std::size_t count,
                   const glm::dmat3& world_from_mesh,
                   std::vector<glm::vec4>& turned) {
    for (const glm::vec3 v : vectors)
        turned.emplace_back(glm::vec3(world_from_mesh * glm::dvec3(v)), 0.0F);
    turned.resize(turned.size() + count - vectors.size(), glm::vec4(0.0F));
}

DrawRange append(const Mesh& mesh,
                 const glm::dmat4& world_from_mesh,
                 bool has_tangents,
                 Vertices& vertices) {
    const glm::dmat3 linear(world_from_mesh);
    const auto first_vertex = static_cast<std::uint32_t>(vertices.positions.size());
    DrawRange range;
    range.first_index = static_cast<std::uint32_t>(vertices.indices.size());
    range.indices = static_cast<std::uint32_t>(3 * mesh.triangles.size());
    range.low_world_m = glm::dvec3(std::numeric_limits<double>::infinity());
    range.high_world_m = -range.low_world_m;
    for (const glm::vec3 p : mesh.positions_m) {
        const glm::dvec3 world_m(world_from_mesh * glm::dvec4(p, 1.0));
        range.low_world_m = glm::min(range.low_world_m, world_m);
        range.high_world_m = glm::max(range.high_world_m, world_m);
        vertices.positions.emplace_back(glm::vec3(world_m), static_cast<float>(1 + mesh.material));
    }
    append_turned(mesh.normals, mesh.positions_m.size(), glm::transpose(glm::inverse(linear)),
                  vertices.normals);
    if (has_tangents)
        append_turned(mesh.tangents, mesh.positions_m.size(), linear, vertices.tangents);
    for (const glm::uvec3 triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner)
            vertices.indices.push_back(first_vertex + triangle[corner]);
    return range;
}

template <typename T>
std::size_t hash_of(const std::vector<T>& values) {
    return std::hash<std::string_view>{}(
        {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

VertexArray make_array(const Buffer& positions, const Buffer& indices) {
    GLuint id = 0;
    glCreateVertexArrays(1, &id);
    VertexArray array(id);
    glVertexArrayVertexBuffer(id, 0, positions.id(), 0, sizeof(glm::vec4));
    glEnableVertexArrayAttrib(id, 0);
    glVertexArrayAttribFormat(id, 0, 4, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(id, 0, 0);
    glVertexArrayElementBuffer(id, indices.id());
    return array;
}

}  // namespace

Buffer upload_materials(Device& device, const std::vector<shared::Brdf>& brdfs) {
    std::vector<MaterialBlock> blocks;
    blocks.reserve(brdfs.size());
    for (const shared::Brdf& brdf : brdfs)
        blocks.push_back({glm::vec4(brdf.diffuse, brdf.exponent),
                          glm::vec4(brdf.specular, static_cast<float>(brdf.kind)),
                          glm::vec4(brdf.alpha, 0.0F, 0.0F), glm::vec4(brdf.cosines, 0.0F)});
    return make_buffer_of(device, blocks, "materials");
}

SceneBuffers upload_scene(Device& device, const Scene& scene) {
    SceneBuffers buffers;
    buffers.has_tangents = needs_tangents(scene);
    Vertices vertices;
    buffers.instances.reserve(scene.instances.size());
    for (const Instance& instance : scene.instances)
        buffers.instances.push_back(append(scene.meshes[static_cast<std::size_t>(instance.mesh)],
                                           instance.world_from_mesh, buffers.has_tangents,
                                           vertices));
    buffers.positions = make_buffer_of(device, vertices.positions, "vertices");
    buffers.normals = make_buffer_of(device, vertices.normals, "normals");
    if (buffers.has_tangents)
        buffers.tangents = make_buffer_of(device, vertices.tangents, "tangents");
    buffers.indices = make_buffer_of(device, vertices.indices, "triangles");
    buffers.array = make_array(buffers.positions, buffers.indices);
    // Unequal factors, so that two swapped buffers do not cancel.
    buffers.geometry_hash = hash_of(vertices.positions) * 31 + hash_of(vertices.indices);
    std::vector<shared::Brdf> brdfs;
    for (const Material& material : scene.materials)
        brdfs.push_back(brdf(material));
    buffers.materials = upload_materials(device, brdfs);
    device.check("upload of the scene");
    return buffers;
}

}  // namespace nearfield::render::gpu
