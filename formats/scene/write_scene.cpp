// SPDX-License-Identifier: Apache-2.0
#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "formats/scene/brdf_extension.h"
#include "formats/scene/reading.h"
#include "formats/scene/scene.h"

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

namespace nearfield {
namespace {

/// Appends values to the buffer as a view and an accessor; returns the accessor's index.
template <typename T>
int add_accessor(tinygltf::Model& model,
                 const std::vector<T>& values,
                 int type,
                 int component_type,
                 std::size_t count,
                 int target) {
    std::vector<unsigned char>& data = model.buffers[0].data;
    const std::size_t bytes = values.size() * sizeof(T);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = bytes;
    view.target = target;
    const auto* first = reinterpret_cast<const unsigned char*>(values.data());
    data.insert(data.end(), first, first + bytes);
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.componentType = component_type;
    accessor.count = count;
    accessor.type = type;
    model.bufferViews.push_back(view);
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
}

tinygltf::Mesh to_gltf(tinygltf::Model& model, const Mesh& mesh) {
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = mesh.material;
    const int positions =
        add_accessor(model, mesh.positions_m, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT,
                     mesh.positions_m.size(), TINYGLTF_TARGET_ARRAY_BUFFER);
    primitive.attributes["POSITION"] = positions;
    // glTF demands the bounds of positions.
    glm::vec3 low(mesh.positions_m.front()), high(low);
    for (const glm::vec3& position : mesh.positions_m) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    model.accessors[static_cast<std::size_t>(positions)].minValues = {low.x, low.y, low.z};
    model.accessors[static_cast<std::size_t>(positions)].maxValues = {high.x, high.y, high.z};
    if (!mesh.normals.empty())
        primitive.attributes["NORMAL"] =
            add_accessor(model, mesh.normals, TINYGLTF_TYPE_VEC3, TINYGLTF_COMPONENT_TYPE_FLOAT,
                         mesh.normals.size(), TINYGLTF_TARGET_ARRAY_BUFFER);
    if (!mesh.tangents.empty()) {
        std::vector<glm::vec4> tangents;
        for (const glm::vec3& tangent : mesh.tangents)
            tangents.emplace_back(tangent, 1.0F);
        primitive.attributes["TANGENT"] =
            add_accessor(model, tangents, TINYGLTF_TYPE_VEC4, TINYGLTF_COMPONENT_TYPE_FLOAT,
                         tangents.size(), TINYGLTF_TARGET_ARRAY_BUFFER);
    }
    primitive.indices = add_accessor(
        model, mesh.triangles, TINYGLTF_TYPE_SCALAR, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
        3 * mesh.triangles.size(), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    tinygltf::Mesh result;
    result.name = mesh.name;
    result.primitives = {primitive};
    return result;
}

tinygltf::Value to_gltf(glm::vec3 numbers) {
    tinygltf::Value::Array array;
    for (int i = 0; i < 3; ++i)
        array.emplace_back(static_cast<double>(numbers[i]));
    return tinygltf::Value(array);
}

tinygltf::Value to_gltf(const shared::Brdf& brdf) {
    const gltf::BrdfModel& model = gltf::brdf_model(brdf.kind);
    tinygltf::Value::Object extension;
    extension["model"] = tinygltf::Value(std::string(model.name));
    extension["diffuse"] = to_gltf(brdf.diffuse);
    extension["specular"] = to_gltf(brdf.specular);
    const std::map<std::string, tinygltf::Value> shape = {
        {"alpha", tinygltf::Value(
                      tinygltf::Value::Array{tinygltf::Value(static_cast<double>(brdf.alpha.x)),
                                             tinygltf::Value(static_cast<double>(brdf.alpha.y))})},
        {"exponent", tinygltf::Value(static_cast<double>(brdf.exponent))},
        {"cosines", to_gltf(brdf.cosines)}};
    for (const char* member : model.shape)
        if (member != nullptr)
            extension[member] = shape.at(member);
    return tinygltf::Value(extension);
}

tinygltf::Material to_gltf(const Material& material) {
    tinygltf::Material result;
    result.name = material.name;
    const glm::dvec3 color(material.base_color);
    result.pbrMetallicRoughness.baseColorFactor = {color.x, color.y, color.z, 1.0};
    result.pbrMetallicRoughness.metallicFactor = static_cast<double>(material.metallic);
    result.pbrMetallicRoughness.roughnessFactor = static_cast<double>(material.roughness);
    if (material.given_brdf)
        result.extensions[gltf::kBrdfExtension] = to_gltf(*material.given_brdf);
    return result;
}

tinygltf::Value to_gltf(const LuminaireInstance& lamp) {
    tinygltf::Value::Object extension;
    extension["uri"] = tinygltf::Value(lamp.uri);
    extension["on"] = tinygltf::Value(lamp.on);
    extension["dim"] = tinygltf::Value(lamp.dim);
    if (lamp.tint != glm::vec3(1.0F))
        extension["tint"] = to_gltf(lamp.tint);
    tinygltf::Value::Array excludes;
    for (const std::string& name : lamp.excludes)
        excludes.emplace_back(name);
    extension["excludes"] = tinygltf::Value(excludes);
    return tinygltf::Value(extension);
}

tinygltf::Value to_gltf(const SceneEnvironment& environment) {
    const glm::dquat rotation = glm::quat_cast(environment.world_from_environment);
    tinygltf::Value::Array xyzw;
    for (const double value : {rotation.x, rotation.y, rotation.z, rotation.w})
        xyzw.emplace_back(value);
    tinygltf::Value::Object extension;
    extension["uri"] = tinygltf::Value(environment.uri);
    extension["rotation"] = tinygltf::Value(xyzw);
    extension["intensity"] = tinygltf::Value(environment.intensity);
    return tinygltf::Value(extension);
}

tinygltf::Node& add_node(tinygltf::Model& model,
                         const std::string& name,
                         const glm::dmat4& matrix) {
    tinygltf::Node node;
    node.name = name;
    for (int i = 0; i < 16; ++i)
        node.matrix.push_back(matrix[i / 4][i % 4]);
    model.scenes[0].nodes.push_back(static_cast<int>(model.nodes.size()));
    return model.nodes.emplace_back(node);
}

void add_nodes(tinygltf::Model& model, const Scene& scene) {
    for (const Instance& instance : scene.instances)
        add_node(model, instance.name, instance.world_from_mesh).mesh = instance.mesh;
    for (const Camera& camera : scene.cameras) {
        tinygltf::Camera gltf_camera;
        gltf_camera.name = camera.name;
        gltf_camera.type = "perspective";
        gltf_camera.perspective.yfov = camera.yfov_rad;
        gltf_camera.perspective.aspectRatio = camera.aspect;
        gltf_camera.perspective.znear = 0.01;  // demanded by glTF; this renderer has no near plane
        add_node(model, camera.name, camera.world_from_camera).camera =
            static_cast<int>(model.cameras.size());
        model.cameras.push_back(gltf_camera);
    }
    for (const LuminaireInstance& lamp : scene.luminaires)
        add_node(model, lamp.name, lamp.world_from_luminaire)
            .extensions[gltf::kLuminaireExtension] = to_gltf(lamp);
}

}  // namespace

void write_scene(const Scene& scene, const std::string& path, BufferPlace buffer) {
    tinygltf::Model model;
    model.asset.version = "2.0";
    model.asset.generator = program_version();
    model.scenes.emplace_back();
    model.defaultScene = 0;
    model.buffers.emplace_back();
    for (const Material& material : scene.materials)
        model.materials.push_back(to_gltf(material));
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.positions_m.empty() || mesh.triangles.empty())
            throw Error{"cannot write scene", path, "meshes with triangles",
                        "'" + mesh.name + "' without"};
        model.meshes.push_back(to_gltf(model, mesh));
    }
    add_nodes(model, scene);
    if (scene.environment) {
        model.scenes[0].extensions[gltf::kEnvironmentExtension] = to_gltf(*scene.environment);
        model.extensionsUsed.emplace_back(gltf::kEnvironmentExtension);
    }
    if (!scene.luminaires.empty())
        model.extensionsUsed.emplace_back(gltf::kLuminaireExtension);
    if (std::any_of(scene.materials.begin(), scene.materials.end(),
                    [](const Material& material) { return material.given_brdf.has_value(); }))
        model.extensionsUsed.emplace_back(gltf::kBrdfExtension);
    if (model.buffers[0].data.empty())
        model.buffers.clear();  // lamps and cameras alone

    const bool is_binary = std::filesystem::path(path).extension() == ".glb";
    std::ostringstream stream;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, !is_binary, is_binary))
        throw Error{"cannot write scene", path};
    std::string text = stream.str();
    if (!is_binary && buffer == BufferPlace::SideFile && !model.buffers.empty()) {
        const auto bin = std::filesystem::path(path).replace_extension(".bin");
        const std::vector<unsigned char>& data = model.buffers[0].data;
        write_file({reinterpret_cast<const char*>(data.data()), data.size()}, bin.string());
        auto document = nlohmann::ordered_json::parse(text);
        document["buffers"][0]["uri"] = bin.filename().string();
        text = document.dump(2) + "\n";
    }
    write_file(text, path);
}

}  // namespace nearfield
