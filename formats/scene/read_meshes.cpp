// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/scene/gltf_accessor.h"
#include "formats/scene/reading.h"

#include <fmt/format.h>

#include <cmath>

namespace nearfield::gltf {
namespace {

/// Keeps memory within what the buffers' size justifies.
struct DecodedBytes {
    std::size_t count = 0, limit = 0;

    void add(std::size_t bytes, const std::string& where) {
        count += bytes;
        if (count > limit)
            throw Error{
                kReadingScene, where,
                fmt::format("primitives of at most {} bytes in all, by the buffers' size", limit),
                "more: the same data used over and over"};
    }
};

/// The directions of an attribute, normalized; none where the primitive has no such attribute.
template <typename Vector>
std::vector<glm::vec3> read_directions(const tinygltf::Model& model,
                                       const tinygltf::Primitive& primitive,
                                       const char* attribute,
                                       std::size_t count,
                                       std::vector<Vector> (*read)(const tinygltf::Model&,
                                                                   int,
                                                                   const std::string&),
                                       const std::string& primitive_place) {
    const auto found = primitive.attributes.find(attribute);
    if (found == primitive.attributes.end())
        return {};
    const std::string where = fmt::format("{}.attributes.{}", primitive_place, attribute);
    const std::vector<Vector> source = read(model, found->second, where);
    if (source.size() != count)
        throw Error{kReadingScene, where, fmt::format("{} of them, one a position", count),
                    fmt::format("{}", source.size())};
    std::vector<glm::vec3> directions;
    directions.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 direction(source[i]);
        const float length = glm::length(direction);
        if (!(std::abs(length - 1.0F) < 0.1F))
            throw Error{kReadingScene, fmt::format("{}, element {}", where, i), "unit length",
                        fmt::format("{}", length)};
        directions.push_back(direction / length);
    }
    return directions;
}

std::vector<std::uint32_t> read_corners(const tinygltf::Model& model,
                                        const tinygltf::Primitive& primitive,
                                        std::size_t positions,
                                        const std::string& where) {
    std::vector<std::uint32_t> corners;
    if (primitive.indices >= 0) {
        corners = read_indices(model, primitive.indices, positions, where + ".indices");
    } else {
        corners.resize(positions);
        for (std::size_t i = 0; i < positions; ++i)
            corners[i] = static_cast<std::uint32_t>(i);
    }
    if (corners.size() % 3 != 0)
        throw Error{kReadingScene, where, "three indices a triangle",
                    fmt::format("{} indices", corners.size())};
    return corners;
}

Mesh read_primitive(Reading& reading,
                    const tinygltf::Primitive& primitive,
                    DecodedBytes& decoded,
                    const std::string& where) {
    Mesh mesh;
    mesh.material = material_index(reading, primitive.material, where);
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end())
        throw Error{kReadingScene, where + ".attributes", "POSITION", "none"};
    mesh.positions_m = read_vec3(reading.model, position->second, where + ".attributes.POSITION");
    const std::size_t count = mesh.positions_m.size();
    decoded.add(count * sizeof(glm::vec3), where);

    mesh.normals = read_directions(reading.model, primitive, "NORMAL", count, &read_vec3, where);
    decoded.add(mesh.normals.size() * sizeof(glm::vec3), where);
    // glTF 2.0, 3.7.2.1: without normals tangents are ignored.
    if (!mesh.normals.empty())
        mesh.tangents =
            read_directions(reading.model, primitive, "TANGENT", count, &read_vec4, where);
    decoded.add(mesh.tangents.size() * sizeof(glm::vec4), where);

    const std::vector<std::uint32_t> corners = read_corners(reading.model, primitive, count, where);
    decoded.add(corners.size() * sizeof(std::uint32_t), where);
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        mesh.triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
    return mesh;
}

}  // namespace

void read_meshes(Reading& reading) {
    // A vertex of a few bytes may be decoded to more, and primitives may share vertices.
    constexpr std::size_t kShare = 16;
    DecodedBytes decoded;
    for (const tinygltf::Buffer& buffer : reading.model.buffers)
        decoded.limit += kShare * buffer.data.size();

    reading.meshes_of.resize(reading.model.meshes.size());
    for (std::size_t i = 0; i < reading.model.meshes.size(); ++i) {
        const tinygltf::Mesh& source = reading.model.meshes[i];
        for (std::size_t j = 0; j < source.primitives.size(); ++j) {
            const tinygltf::Primitive& primitive = source.primitives[j];
            const std::string place = fmt::format("meshes[{}].primitives[{}]", i, j);
            if (primitive.mode >= 0 && primitive.mode < TINYGLTF_MODE_TRIANGLES) {
                reading.scene.notes.push_back(place + ": points or lines left out");
                continue;
            }
            if (primitive.mode > TINYGLTF_MODE_TRIANGLES)
                throw Error{kReadingScene, reading.at(place + ".mode"), "triangles (4)",
                            fmt::format("{}", primitive.mode)};
            Mesh mesh = read_primitive(reading, primitive, decoded, reading.at(place));
            mesh.name = source.name;
            reading.meshes_of[i].push_back(static_cast<int>(reading.scene.meshes.size()));
            reading.scene.meshes.push_back(std::move(mesh));
        }
    }
}

}  // namespace nearfield::gltf
