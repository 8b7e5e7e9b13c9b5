// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "formats/scene/gltf_guard.h"
#include "formats/scene/reading.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace nearfield::gltf {
namespace {

glm::dmat4 local_matrix(const tinygltf::Node& node, const std::string& where) {
    glm::dmat4 matrix(1.0);
    if (!node.matrix.empty()) {
        for (int i = 0; i < 16; ++i)
            matrix[i / 4][i % 4] = node.matrix.at(static_cast<std::size_t>(i));
        if (glm::dvec4(matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3]) !=
            glm::dvec4(0, 0, 0, 1))
            throw Error{kReadingScene, where + ".matrix", "a last row of 0 0 0 1", "another"};
        return matrix;
    }
    if (!node.translation.empty())
        matrix[3] = {node.translation.at(0), node.translation.at(1), node.translation.at(2), 1.0};
    if (!node.rotation.empty()) {
        const glm::dquat rotation(node.rotation.at(3), node.rotation.at(0), node.rotation.at(1),
                                  node.rotation.at(2));
        if (!(std::abs(glm::length(rotation) - 1.0) < 1e-3))
            throw Error{kReadingScene, where + ".rotation", "a quaternion of unit length",
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
                throw Error{kReadingScene, where,
                            fmt::format("a transform of numbers up to {:g}", kLargest),
                            fmt::format("{}", matrix[column][row])};
    const double determinant = glm::determinant(glm::dmat3(matrix));
    if (!(std::abs(determinant) >= kSmallestDeterminant))
        throw Error{kReadingScene, where, "an invertible transform",
                    fmt::format("determinant {:g}", determinant)};
}

glm::vec3 read_tint(const tinygltf::Value& value, const std::string& where) {
    glm::vec3 tint(0.0F);
    bool fits = value.IsArray() && value.ArrayLen() == 3;
    for (int c = 0; fits && c < 3; ++c) {
        fits = value.Get(c).IsNumber();
        tint[c] = fits ? static_cast<float>(value.Get(c).GetNumberAsDouble()) : 0.0F;
        fits = fits && tint[c] >= 0.0F && tint[c] <= 1.0F;
    }
    if (!fits)
        throw Error{kReadingScene, where, "3 numbers from 0 to 1", "something else"};
    return tint;
}

void read_luminaire(Reading& reading,
                    const tinygltf::Node& node,
                    const tinygltf::Value& extension,
                    const glm::dmat4& world_from_node,
                    const glm::dmat4& world_from_parent,
                    int index) {
    const std::string place = fmt::format("nodes[{}]", index);
    const auto where = [&](const std::string& member) {
        return reading.at(fmt::format("{}.extensions.{}{}", place, kLuminaireExtension, member));
    };
    const auto refuse = [&](const std::string& member, const std::string& expected) {
        throw Error{kReadingScene, where("." + member), expected,
                    extension.Has(member) ? "something else" : "none"};
    };
    if (!extension.IsObject())
        throw Error{kReadingScene, where(""), "an object", "something else"};
    static const std::set<std::string> known = {"uri", "on", "dim", "tint", "excludes", "extras"};
    for (const std::string& key : extension.Keys())
        if (known.count(key) == 0)
            throw Error{kReadingScene, where(""), "uri, on, dim, tint, excludes",
                        "'" + key.substr(0, 40) + "'"};

    LuminaireInstance lamp;
    lamp.name = node.name;
    lamp.node = index;
    lamp.world_from_parent = world_from_parent;
    lamp.world_from_luminaire = world_from_node;
    uniform_scale(world_from_node, reading.at(place));
    if (!extension.Get("uri").IsString())
        refuse("uri", "the light field's file, a string");
    lamp.uri = extension.Get("uri").Get<std::string>();
    lamp.path = resolve_uri(lamp.uri, reading.base_folder, where(".uri"));
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
            throw Error{kReadingScene, where(".dim"), "a number from 0 to 1e9",
                        fmt::format("{}", lamp.dim)};
    }
    if (extension.Has("tint"))
        lamp.tint = read_tint(extension.Get("tint"), where(".tint"));
    const tinygltf::Value& excludes = extension.Get("excludes");
    if (extension.Has("excludes") && !excludes.IsArray())
        refuse("excludes", "an array of names");
    for (std::size_t i = 0; i < excludes.ArrayLen(); ++i) {
        if (!excludes.Get(static_cast<int>(i)).IsString())
            throw Error{kReadingScene, where(fmt::format(".excludes[{}]", i)), "a name",
                        "something else"};
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
        throw Error{kReadingScene, reading.at(place + ".camera"),
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
        throw Error{kReadingScene, where + ".yfov", "an angle from 0 to pi",
                    fmt::format("{}", camera.yfov_rad)};
    if (!(camera.aspect >= 0.0 && camera.aspect <= 1e4))
        throw Error{kReadingScene, where + ".aspectRatio", "a number from 0 to 10000",
                    fmt::format("{}", camera.aspect)};
    reading.scene.cameras.push_back(std::move(camera));
}

void read_node(Reading& reading,
               int index,
               const glm::dmat4& world_from_node,
               const glm::dmat4& world_from_parent) {
    const tinygltf::Node& node = reading.model.nodes[static_cast<std::size_t>(index)];
    const std::string place = fmt::format("nodes[{}]", index);
    if (node.mesh >= 0) {
        if (static_cast<std::size_t>(node.mesh) >= reading.meshes_of.size())
            throw Error{kReadingScene, reading.at(place + ".mesh"),
                        fmt::format("an index into {} meshes", reading.meshes_of.size()),
                        fmt::format("{}", node.mesh)};
        for (const int mesh : reading.meshes_of[static_cast<std::size_t>(node.mesh)])
            reading.scene.instances.push_back({node.name, mesh, world_from_node});
    }
    if (node.camera >= 0)
        read_camera(reading, node, world_from_node, place);
    if (const auto found = node.extensions.find(kLuminaireExtension);
        found != node.extensions.end())
        read_luminaire(reading, node, found->second, world_from_node, world_from_parent, index);
}

}  // namespace

void read_nodes(Reading& reading) {
    const tinygltf::Model& model = reading.model;
    if (model.scenes.empty())
        throw Error{kReadingScene, reading.at("scenes"), "at least one", "none"};
    const int scene = std::max(model.defaultScene, 0);
    if (static_cast<std::size_t>(scene) >= model.scenes.size())
        throw Error{kReadingScene, reading.at("scene"),
                    fmt::format("an index into {} scenes", model.scenes.size()),
                    fmt::format("{}", scene)};
    struct Visit {
        int node;
        glm::dmat4 world_from_parent;
    };
    // Parents first, without recursion. A node is listed once, so that the stack holds at most all.
    std::vector<Visit> stack;
    std::vector<bool> listed(model.nodes.size());
    const auto push = [&](const std::vector<int>& nodes, const glm::dmat4& world_from_parent,
                          const std::string& place) {
        for (const int node : nodes) {
            const auto index = static_cast<std::size_t>(node);
            if (node < 0 || index >= model.nodes.size())
                throw Error{kReadingScene, reading.at(place),
                            fmt::format("indices into {} nodes", model.nodes.size()),
                            fmt::format("{}", node)};
            if (listed[index])
                throw Error{kReadingScene, reading.at(place), "a tree",
                            fmt::format("nodes[{}] a second time", node)};
            listed[index] = true;
        }
        for (auto node = nodes.rbegin(); node != nodes.rend(); ++node)
            stack.push_back({*node, world_from_parent});
    };
    push(model.scenes[static_cast<std::size_t>(scene)].nodes, glm::dmat4(1.0),
         fmt::format("scenes[{}].nodes", scene));
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(visit.node)];
        const std::string place = fmt::format("nodes[{}]", visit.node);
        const glm::dmat4 world_from_node =
            visit.world_from_parent * local_matrix(node, reading.at(place));
        check_matrix(world_from_node, reading.at(place));
        read_node(reading, visit.node, world_from_node, visit.world_from_parent);
        push(node.children, world_from_node, place + ".children");
    }
}

}  // namespace nearfield::gltf
