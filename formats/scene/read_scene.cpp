// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/scene/gltf_accessor.h"
#include "formats/scene/gltf_guard.h"
#include "formats/scene/scene.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace nearfield {
namespace {

constexpr const char* kWhat = "cannot read scene";
constexpr const char* kExtension = "NEARFIELD_luminaire";

/// The document and what its parts have become.
struct Reading {
    std::string path, base_folder;
    tinygltf::Model model;
    Scene scene;
    std::vector<std::vector<int>> meshes_of;  // scene meshes (one a primitive) of each glTF mesh
    std::size_t decoded_bytes = 0, decoded_bytes_limit = 0;

    std::string at(const std::string& place) const { return path + ": " + place; }
};

tinygltf::Model load_model(const std::string& path, const gltf::GuardedFile& file) {
    tinygltf::TinyGLTF loader;
    // The library's own path expansion runs a shell's word expansion on names found in the file.
    loader.SetFsCallbacks({&tinygltf::FileExists,
                           [](const std::string& name, void* /*user*/) { return name; },
                           &tinygltf::ReadWholeFile, &tinygltf::WriteWholeFile, nullptr});
    tinygltf::Model model;
    std::string error, warning;
    bool loaded = false;
    try {
        if (file.is_binary) {
            const std::string glb = gltf::join_glb(file);
            loaded = loader.LoadBinaryFromMemory(
                &model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()),
                static_cast<unsigned>(glb.size()), file.base_folder);
        } else {
            loaded = loader.LoadASCIIFromString(&model, &error, &warning, file.json.data(),
                                                static_cast<unsigned>(file.json.size()),
                                                file.base_folder);
        }
    } catch (const std::exception& failure) {
        error = failure.what();
    }
    if (!loaded)
        throw Error{kWhat, path, "glTF 2.0", error.substr(0, 200)};
    return model;
}

float unit_factor(double value, const std::string& where) {
    if (!(value >= 0.0 && value <= 1.0))
        throw Error{kWhat, where, "a number from 0 to 1", fmt::format("{}", value)};
    return static_cast<float>(value);
}

void read_materials(Reading& reading) {
    for (std::size_t i = 0; i < reading.model.materials.size(); ++i) {
        const tinygltf::Material& source = reading.model.materials[i];
        const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
        const std::string where = reading.at(fmt::format("materials[{}].pbrMetallicRoughness", i));
        Material material;
        material.name = source.name;
        for (int c = 0; c < 3; ++c)
            material.base_color[c] = unit_factor(
                pbr.baseColorFactor.at(static_cast<std::size_t>(c)), where + ".baseColorFactor");
        material.metallic = unit_factor(pbr.metallicFactor, where + ".metallicFactor");
        material.roughness = unit_factor(pbr.roughnessFactor, where + ".roughnessFactor");
        if (pbr.baseColorTexture.index >= 0 || pbr.metallicRoughnessTexture.index >= 0 ||
            source.normalTexture.index >= 0)
            reading.scene.notes.push_back(
                fmt::format("materials[{}] '{}': textures left out, factors used", i, source.name));
        reading.scene.materials.push_back(material);
    }
}

/// Index of the scene's material for a primitive; glTF's default material is appended where it is
/// needed.
int material_index(Reading& reading, int index, const std::string& where) {
    const auto count = reading.model.materials.size();
    if (index >= 0 && static_cast<std::size_t>(index) < count)
        return index;
    if (index >= 0)
        throw Error{kWhat, where + ".material", fmt::format("an index into {} materials", count),
                    fmt::format("{}", index)};
    if (reading.scene.materials.size() == count)
        reading.scene.materials.push_back({"default", glm::vec3(1.0F), 1.0F, 1.0F});
    return static_cast<int>(count);
}

void count_decoded(Reading& reading, std::size_t bytes, const std::string& where) {
    reading.decoded_bytes += bytes;
    if (reading.decoded_bytes > reading.decoded_bytes_limit)
        throw Error{kWhat, where,
                    fmt::format("primitives of at most {} bytes in all, by the buffers' size",
                                reading.decoded_bytes_limit),
                    "more: the same data used over and over"};
}

Mesh read_primitive(Reading& reading,
                    const tinygltf::Primitive& primitive,
                    const std::string& where) {
    Mesh mesh;
    mesh.material = material_index(reading, primitive.material, where);
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end())
        throw Error{kWhat, where + ".attributes", "POSITION", "none"};
    mesh.positions_m =
        gltf::read_vec3(reading.model, position->second, where + ".attributes.POSITION");
    count_decoded(reading, mesh.positions_m.size() * sizeof(glm::vec3), where);

    if (const auto normal = primitive.attributes.find("NORMAL");
        normal != primitive.attributes.end()) {
        mesh.normals = gltf::read_vec3(reading.model, normal->second, where + ".attributes.NORMAL");
        count_decoded(reading, mesh.normals.size() * sizeof(glm::vec3), where);
        if (mesh.normals.size() != mesh.positions_m.size())
            throw Error{kWhat, where + ".attributes.NORMAL",
                        fmt::format("{} normals", mesh.positions_m.size()),
                        fmt::format("{}", mesh.normals.size())};
        for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
            const float length = glm::length(mesh.normals[i]);
            if (!(std::abs(length - 1.0F) < 0.1F))
                throw Error{kWhat, fmt::format("{}.attributes.NORMAL, element {}", where, i),
                            "unit length", fmt::format("{}", length)};
            mesh.normals[i] /= length;
        }
    }

    std::vector<std::uint32_t> indices;
    if (primitive.indices >= 0) {
        indices = gltf::read_indices(reading.model, primitive.indices, mesh.positions_m.size(),
                                     where + ".indices");
    } else {
        indices.resize(mesh.positions_m.size());
        for (std::size_t i = 0; i < indices.size(); ++i)
            indices[i] = static_cast<std::uint32_t>(i);
    }
    count_decoded(reading, indices.size() * sizeof(std::uint32_t), where);
    if (indices.size() % 3 != 0)
        throw Error{kWhat, where, "three indices a triangle",
                    fmt::format("{} indices", indices.size())};
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
        mesh.triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
    return mesh;
}

void read_meshes(Reading& reading) {
    // A vertex of a few bytes may be decoded to more, and primitives may share vertices.
    constexpr std::size_t kShare = 16;
    for (const tinygltf::Buffer& buffer : reading.model.buffers)
        reading.decoded_bytes_limit += kShare * buffer.data.size();

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
                throw Error{kWhat, reading.at(place + ".mode"), "triangles (4)",
                            fmt::format("{}", primitive.mode)};
            Mesh mesh = read_primitive(reading, primitive, reading.at(place));
            mesh.name = source.name;
            reading.meshes_of[i].push_back(static_cast<int>(reading.scene.meshes.size()));
            reading.scene.meshes.push_back(std::move(mesh));
        }
    }
}

glm::dmat4 local_matrix(const tinygltf::Node& node, const std::string& where) {
    glm::dmat4 matrix(1.0);
    if (!node.matrix.empty()) {
        for (int i = 0; i < 16; ++i)
            matrix[i / 4][i % 4] = node.matrix.at(static_cast<std::size_t>(i));
        if (glm::dvec4(matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3]) !=
            glm::dvec4(0, 0, 0, 1))
            throw Error{kWhat, where + ".matrix", "a last row of 0 0 0 1", "another"};
        return matrix;
    }
    if (!node.translation.empty())
        matrix[3] = {node.translation.at(0), node.translation.at(1), node.translation.at(2), 1.0};
    if (!node.rotation.empty()) {
        const glm::dquat rotation(node.rotation.at(3), node.rotation.at(0), node.rotation.at(1),
                                  node.rotation.at(2));
        if (!(std::abs(glm::length(rotation) - 1.0) < 1e-3))
            throw Error{kWhat, where + ".rotation", "a quaternion of unit length",
                        fmt::format("length {}", glm::length(rotation))};
        matrix *= glm::mat4_cast(glm::normalize(rotation));
    }
    for (int axis = 0; axis < 3 && !node.scale.empty(); ++axis)
        matrix[axis] *= node.scale.at(static_cast<std::size_t>(axis));
    return matrix;
}

/// Throws if the matrix is not finite, too large for single precision, or flattens space.
void check_matrix(const glm::dmat4& matrix, const std::string& where) {
    constexpr double kLargest = 1e9, kSmallestDeterminant = 1e-30;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!(std::abs(matrix[column][row]) <= kLargest))
                throw Error{kWhat, where,
                            fmt::format("a transform of numbers up to {:g}", kLargest),
                            fmt::format("{}", matrix[column][row])};
    const double determinant = glm::determinant(glm::dmat3(matrix));
    if (!(std::abs(determinant) >= kSmallestDeterminant))
        throw Error{kWhat, where, "an invertible transform",
                    fmt::format("determinant {:g}", determinant)};
}

void read_luminaire(Reading& reading,
                    const tinygltf::Node& node,
                    const tinygltf::Value& extension,
                    const glm::dmat4& world_from_node,
                    const std::string& place) {
    const auto where = [&](const std::string& member) {
        return reading.at(fmt::format("{}.extensions.{}{}", place, kExtension, member));
    };
    const auto refuse = [&](const std::string& member, const std::string& expected) {
        throw Error{kWhat, where("." + member), expected,
                    extension.Has(member) ? "something else" : "none"};
    };
    if (!extension.IsObject())
        throw Error{kWhat, where(""), "an object", "something else"};
    static const std::set<std::string> known = {"uri", "on", "dim", "excludes", "extras"};
    for (const std::string& key : extension.Keys())
        if (known.count(key) == 0)
            throw Error{kWhat, where(""), "uri, on, dim, excludes", "'" + key.substr(0, 40) + "'"};

    LuminaireInstance lamp;
    lamp.name = node.name;
    lamp.world_from_luminaire = world_from_node;
    uniform_scale(world_from_node, reading.at(place));
    if (!extension.Get("uri").IsString())
        refuse("uri", "the light field's file, a string");
    lamp.uri = extension.Get("uri").Get<std::string>();
    lamp.path = gltf::resolve_uri(lamp.uri, reading.base_folder, where(".uri"));
    if (extension.Has("on")) {
        if (!extension.Get("on").IsBool())
            refuse("on", "true or false");
        lamp.on = extension.Get("on").Get<bool>();
    }
    if (extension.Has("dim")) {
        if (!extension.Get("dim").IsNumber())
            refuse("dim", "a number >= 0");
        lamp.dim = extension.Get("dim").GetNumberAsDouble();
        if (!(lamp.dim >= 0.0 && lamp.dim <= 1e9))
            throw Error{kWhat, where(".dim"), "a number from 0 to 1e9",
                        fmt::format("{}", lamp.dim)};
    }
    const tinygltf::Value& excludes = extension.Get("excludes");
    if (extension.Has("excludes") && !excludes.IsArray())
        refuse("excludes", "an array of names");
    for (std::size_t i = 0; i < excludes.ArrayLen(); ++i) {
        if (!excludes.Get(static_cast<int>(i)).IsString())
            throw Error{kWhat, where(fmt::format(".excludes[{}]", i)), "a name", "something else"};
        lamp.excludes.push_back(excludes.Get(static_cast<int>(i)).Get<std::string>());
    }
    reading.scene.luminaires.push_back(std::move(lamp));
}

void read_camera(Reading& reading,
                 const tinygltf::Node& node,
                 const glm::dmat4& world_from_node,
                 const std::string& place) {
    const auto index = static_cast<std::size_t>(node.camera);
    if (index >= reading.model.cameras.size())
        throw Error{kWhat, reading.at(place + ".camera"),
                    fmt::format("an index into {} cameras", reading.model.cameras.size()),
                    fmt::format("{}", node.camera)};
    const tinygltf::Camera& source = reading.model.cameras[index];
    if (source.type != "perspective") {
        reading.scene.notes.push_back(
            fmt::format("cameras[{}]: only perspective is supported", index));
        return;
    }
    Camera camera;
    camera.name = node.name.empty() ? source.name : node.name;
    camera.world_from_camera = world_from_node;
    camera.yfov_rad = source.perspective.yfov;
    camera.aspect = source.perspective.aspectRatio;
    const std::string where = reading.at(fmt::format("cameras[{}].perspective", index));
    if (!(camera.yfov_rad > 1e-6 && camera.yfov_rad < 3.1415))
        throw Error{kWhat, where + ".yfov", "an angle from 0 to pi",
                    fmt::format("{}", camera.yfov_rad)};
    if (!(camera.aspect >= 0.0 && camera.aspect <= 1e4))
        throw Error{kWhat, where + ".aspectRatio", "a number from 0 to 10000",
                    fmt::format("{}", camera.aspect)};
    reading.scene.cameras.push_back(std::move(camera));
}

void read_node(Reading& reading, int index, const glm::dmat4& world_from_node) {
    const tinygltf::Node& node = reading.model.nodes[static_cast<std::size_t>(index)];
    const std::string place = fmt::format("nodes[{}]", index);
    if (node.mesh >= 0) {
        if (static_cast<std::size_t>(node.mesh) >= reading.meshes_of.size())
            throw Error{kWhat, reading.at(place + ".mesh"),
                        fmt::format("an index into {} meshes", reading.meshes_of.size()),
                        fmt::format("{}", node.mesh)};
        for (const int mesh : reading.meshes_of[static_cast<std::size_t>(node.mesh)])
            reading.scene.instances.push_back({node.name, mesh, world_from_node});
    }
    if (node.camera >= 0)
        read_camera(reading, node, world_from_node, place);
    if (const auto found = node.extensions.find(kExtension); found != node.extensions.end())
        read_luminaire(reading, node, found->second, world_from_node, place);
}

/// Walks the scene's node trees without recursion, parents first.
void read_nodes(Reading& reading) {
    const tinygltf::Model& model = reading.model;
    if (model.scenes.empty())
        throw Error{kWhat, reading.at("scenes"), "at least one", "none"};
    const int scene = std::max(model.defaultScene, 0);
    if (static_cast<std::size_t>(scene) >= model.scenes.size())
        throw Error{kWhat, reading.at("scene"),
                    fmt::format("an index into {} scenes", model.scenes.size()),
                    fmt::format("{}", scene)};
    struct Visit {
        int node;
        glm::dmat4 world_from_parent;
        std::string place;
    };
    std::vector<Visit> stack;
    const auto push = [&](const std::vector<int>& nodes, const glm::dmat4& world_from_parent,
                          const std::string& place) {
        for (auto node = nodes.rbegin(); node != nodes.rend(); ++node)
            stack.push_back({*node, world_from_parent, place});
    };
    push(model.scenes[static_cast<std::size_t>(scene)].nodes, glm::dmat4(1.0),
         fmt::format("scenes[{}].nodes", scene));
    std::vector<bool> visited(model.nodes.size());
    while (!stack.empty()) {
        const Visit visit = std::move(stack.back());
        stack.pop_back();
        const auto index = static_cast<std::size_t>(visit.node);
        if (visit.node < 0 || index >= model.nodes.size())
            throw Error{kWhat, reading.at(visit.place),
                        fmt::format("indices into {} nodes", model.nodes.size()),
                        fmt::format("{}", visit.node)};
        if (visited[index])
            throw Error{kWhat, reading.at(visit.place), "a tree",
                        fmt::format("nodes[{}] a second time", visit.node)};
        visited[index] = true;
        const std::string where = reading.at(fmt::format("nodes[{}]", visit.node));
        const glm::dmat4 world_from_node =
            visit.world_from_parent * local_matrix(model.nodes[index], where);
        check_matrix(world_from_node, where);
        read_node(reading, visit.node, world_from_node);
        push(model.nodes[index].children, world_from_node,
             fmt::format("nodes[{}].children", visit.node));
    }
}

void check_extensions(const Reading& reading) {
    for (const std::string& name : reading.model.extensionsRequired)
        if (name != kExtension)
            throw Error{kWhat, reading.at("extensionsRequired"), kExtension, name.substr(0, 60)};
    const auto& used = reading.model.extensionsUsed;
    if (!reading.scene.luminaires.empty() &&
        std::find(used.begin(), used.end(), kExtension) == used.end())
        throw Error{kWhat, reading.at("extensionsUsed"), kExtension, "none"};
}

/// A name that excludes nothing is a typing error that would show as a shadow.
void check_excludes(const Reading& reading) {
    std::set<std::string> names;
    for (const Instance& instance : reading.scene.instances) {
        names.insert(instance.name);
        names.insert(reading.scene.meshes[static_cast<std::size_t>(instance.mesh)].name);
    }
    for (const LuminaireInstance& lamp : reading.scene.luminaires)
        for (const std::string& name : lamp.excludes)
            if (names.count(name) == 0)
                throw Error{
                    kWhat, reading.at(fmt::format("{} '{}', excludes", kExtension, lamp.name)),
                    "the name of a mesh or of a node that has one", "'" + name.substr(0, 60) + "'"};
}

}  // namespace

Scene read_scene(const std::string& path) {
    Reading reading;
    reading.path = path;
    const gltf::GuardedFile file = gltf::read_guarded(path);
    reading.base_folder = file.base_folder;
    reading.model = load_model(path, file);
    read_materials(reading);
    read_meshes(reading);
    read_nodes(reading);
    check_extensions(reading);
    check_excludes(reading);
    return std::move(reading.scene);
}

}  // namespace nearfield
