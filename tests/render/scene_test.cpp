// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/scene.h"

#include "formats/files/error.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

namespace nearfield {
namespace {

using nlohmann::json;

/// A BRDF of numbers that floats in decimal notation may spoil.
shared::Brdf given_brdf(shared::uint kind) {
    shared::Brdf brdf{};
    brdf.kind = kind;
    brdf.diffuse = {0.1F, 1.0F / 3.0F, 0.0F};
    brdf.specular = {0.7F, 0.04F, 1.0F};
    brdf.exponent = 12.3F;
    brdf.alpha = {0.05F, 0.3F};
    brdf.cosines = {-0.9F, -1.0F, 0.98F};
    return brdf;
}

Scene sample_scene() {
    Scene scene = test::floor_scene();
    scene.meshes[0].normals.assign(4, {0, 0, 1});
    scene.materials.push_back({"brass", {0.9F, 0.7F, 0.3F}, 1.0F, 0.25F});
    test::add_blocker(scene, "plate", {0.5, 0.25, 1}, {1, 2});
    scene.meshes[1].material = 1;
    scene.meshes[1].normals.assign(4, {0, 0, 1});
    scene.meshes[1].tangents.assign(4, {0, 1, 0});
    for (shared::uint kind = shared::kBrdfPhong; kind <= shared::kBrdfHalfwayDisk; ++kind)
        scene.materials.push_back({"given", {0.1F, 0.2F, 0.3F}, 0.5F, 0.5F, given_brdf(kind)});
    scene.cameras[0].aspect = 1.5;
    LuminaireInstance lamp;
    lamp.name = "left";
    lamp.uri = "lamps/left lamp.luminaire.exr";
    lamp.world_from_luminaire = test::pose({1, 2, 3}, {0, 1, -1});
    lamp.dim = 0.125;
    lamp.excludes = {"plate"};
    scene.luminaires = {lamp};
    scene.luminaires.push_back(lamp);
    scene.luminaires[1].on = false;
    scene.luminaires[1].world_from_luminaire[0] *= -1.0;  // mirrored
    return scene;
}

/// What a kind has no use for need not survive.
void expect_equal(const shared::Brdf& a, const shared::Brdf& b) {
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.diffuse, b.diffuse);
    EXPECT_EQ(a.specular, b.specular);
    if (a.kind == shared::kBrdfGgx || a.kind == shared::kBrdfWard) {
        EXPECT_EQ(a.alpha, b.alpha);
    } else {
        EXPECT_EQ(a.exponent, b.exponent);
    }
    if (a.kind == shared::kBrdfLafortune) {
        EXPECT_EQ(a.cosines, b.cosines);
    }
}

void expect_equal(const Scene& a, const Scene& b) {
    ASSERT_EQ(a.meshes.size(), b.meshes.size());
    for (std::size_t i = 0; i < a.meshes.size(); ++i) {
        EXPECT_EQ(a.meshes[i].name, b.meshes[i].name);
        EXPECT_EQ(a.meshes[i].positions_m, b.meshes[i].positions_m);
        EXPECT_EQ(a.meshes[i].normals, b.meshes[i].normals);
        EXPECT_EQ(a.meshes[i].tangents, b.meshes[i].tangents);
        EXPECT_EQ(a.meshes[i].triangles, b.meshes[i].triangles);
        EXPECT_EQ(a.meshes[i].material, b.meshes[i].material);
    }
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (std::size_t i = 0; i < a.materials.size(); ++i) {
        EXPECT_EQ(a.materials[i].name, b.materials[i].name);
        EXPECT_EQ(a.materials[i].base_color, b.materials[i].base_color);
        EXPECT_EQ(a.materials[i].metallic, b.materials[i].metallic);
        EXPECT_EQ(a.materials[i].roughness, b.materials[i].roughness);
        ASSERT_EQ(a.materials[i].given_brdf.has_value(), b.materials[i].given_brdf.has_value());
        if (a.materials[i].given_brdf)
            expect_equal(*a.materials[i].given_brdf, *b.materials[i].given_brdf);
    }
    ASSERT_EQ(a.instances.size(), b.instances.size());
    for (std::size_t i = 0; i < a.instances.size(); ++i)
        EXPECT_EQ(a.instances[i].world_from_mesh, b.instances[i].world_from_mesh);
    ASSERT_EQ(a.cameras.size(), b.cameras.size());
    EXPECT_EQ(a.cameras[0].world_from_camera, b.cameras[0].world_from_camera);
    EXPECT_EQ(a.cameras[0].yfov_rad, b.cameras[0].yfov_rad);
    EXPECT_EQ(a.cameras[0].aspect, b.cameras[0].aspect);
    ASSERT_EQ(a.luminaires.size(), b.luminaires.size());
    for (std::size_t i = 0; i < a.luminaires.size(); ++i) {
        EXPECT_EQ(a.luminaires[i].uri, b.luminaires[i].uri);
        EXPECT_EQ(a.luminaires[i].on, b.luminaires[i].on);
        EXPECT_EQ(a.luminaires[i].dim, b.luminaires[i].dim);
        EXPECT_EQ(a.luminaires[i].excludes, b.luminaires[i].excludes);
        EXPECT_EQ(a.luminaires[i].world_from_luminaire, b.luminaires[i].world_from_luminaire);
    }
}

// Proves that what is written comes back bit by bit, in all three forms of file.
TEST(Scene, RoundTripKeepsEverything) {
    const Scene scene = sample_scene();
    write_scene(scene, "embedded.gltf");
    write_scene(scene, "side.gltf", BufferPlace::SideFile);
    write_scene(scene, "binary.glb");
    EXPECT_TRUE(std::filesystem::exists("side.bin"));
    for (const char* path : {"embedded.gltf", "side.gltf", "binary.glb"}) {
        SCOPED_TRACE(path);
        expect_equal(scene, read_scene(path));
    }
    EXPECT_EQ(read_scene("binary.glb").luminaires[0].path, "lamps/left lamp.luminaire.exr");
}

std::string read_error(const std::string& path) {
    try {
        read_scene(path);
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

json document() {
    write_scene(sample_scene(), "document.gltf");
    std::ifstream file("document.gltf");
    return json::parse(file);
}

std::string error_of(const json& changed) {
    std::ofstream("changed.gltf") << changed.dump();
    return read_error("changed.gltf");
}

struct BadCase {
    const char* pointer;  // JSON pointer to what is replaced
    const char* value;    // JSON
    const char* place;    // what the error must name
};

// Proves that each broken rule is found where it is, and is named with file and place.
TEST(Scene, ErrorsNameFileAndPlace) {
    const std::vector<BadCase> cases = {
        {"/asset/version", "\"1.0\"", "asset.version"},
        {"/nodes/3/extensions/NEARFIELD_luminaire/dim", "-1",
         "nodes[3].extensions.NEARFIELD_luminaire.dim"},
        {"/nodes/3/extensions/NEARFIELD_luminaire/on", "1",
         "nodes[3].extensions.NEARFIELD_luminaire.on"},
        {"/nodes/3/extensions/NEARFIELD_luminaire/uri", "7",
         "nodes[3].extensions.NEARFIELD_luminaire.uri"},
        {"/nodes/3/extensions/NEARFIELD_luminaire/uri", "\"/etc/passwd\"",
         "NEARFIELD_luminaire.uri"},
        {"/nodes/3/extensions/NEARFIELD_luminaire/excludes", "\"a\"",
         "NEARFIELD_luminaire.excludes"},
        {"/nodes/3/extensions/NEARFIELD_luminaire/excludes", "[\"no such\"]", "'no such'"},
        {"/nodes/3/extensions/NEARFIELD_luminaire/dimm", "1", "'dimm'"},
        {"/nodes/3/matrix", "[2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]", "nodes[3]"},
        {"/nodes/3/matrix", "[1,0,0,0, 0,0,0,0, 0,0,1,0, 0,0,0,1]", "nodes[3]"},
        {"/nodes/0/matrix", "[1,0,0]", "nodes[0].matrix"},
        {"/nodes/0/mesh", "17", "nodes[0].mesh"},
        {"/nodes/0/mesh", "\"floor\"", "nodes[0].mesh"},
        {"/nodes/0/children", "[1]", "nodes[1] a second time"},
        {"/nodes/0/children", "[0]", "nodes[0] a second time"},
        {"/nodes/0/children", "[99]", "nodes[0].children"},
        {"/scenes/0/nodes", "[0, 1, 1]", "nodes[1] a second time"},
        {"/scene", "4", "scene"},
        {"/extensionsUsed", "[]", "extensionsUsed"},
        {"/extensionsRequired", "[\"KHR_draco_mesh_compression\"]", "extensionsRequired"},
        {"/cameras/0/perspective/yfov", "4", "cameras[0].perspective.yfov"},
        {"/materials/0/pbrMetallicRoughness/baseColorFactor", "[2,0,0,1]", "materials[0]"},
        {"/materials/1/pbrMetallicRoughness/roughnessFactor", "-0.5", "roughnessFactor"},
        {"/meshes/1/primitives/0/attributes/TANGENT", "0",
         "meshes[1].primitives[0].attributes.TANGENT"},
        {"/meshes/1/primitives/0/attributes/TANGENT", "-1", "TANGENT"},
        {"/meshes/0/primitives/0/material", "99", "meshes[0].primitives[0].material"},
        {"/meshes/0/primitives/0/mode", "5", "meshes[0].primitives[0].mode"},
        {"/meshes/0/primitives/0/attributes/POSITION", "50",
         "meshes[0].primitives[0].attributes.POSITION"},
        {"/accessors/0/count", "5", "accessors[0]"},
        {"/accessors/0/count", "2147483647", "accessors[0]"},
        {"/accessors/0/byteOffset", "4", "accessors[0]"},
        {"/accessors/0/bufferView", "2", "accessors[0]"},
        {"/accessors/0/componentType", "5123", "POSITION"},
        {"/bufferViews/0/byteOffset", "2147483647", "bufferViews[0]"},
        {"/bufferViews/0/byteLength", "2147483647", "bufferViews[0]"},
        {"/bufferViews/0/byteStride", "4", "accessors[0]"},
        {"/buffers/0/byteLength", "1000000", "buffers[0].byteLength"},
        {"/buffers/0/uri", "\"missing.bin\"", "buffers[0].uri"},
    };
    const json good = document();
    for (const BadCase& bad : cases) {
        json changed = good;
        changed[json::json_pointer(bad.pointer)] = json::parse(bad.value);
        const std::string message = error_of(changed);
        EXPECT_NE(message.find("changed.gltf"), std::string::npos)
            << bad.pointer << ": " << message;
        EXPECT_NE(message.find(bad.place), std::string::npos) << bad.pointer << ": " << message;
    }
}

/// The same for materials[2 ... 6]: Phong, GGX, Ward, Lafortune, halfway disk.
const std::vector<BadCase> kBadBrdfs = {
    {"2/model", "\"phung\"", "expected phong, ggx, ward, lafortune, halfway_disk, got 'phung'"},
    {"2/model", "3", "model"},
    {"2/alpha", "0.1", "'alpha'"},
    {"2/exponent", "-1", "NEARFIELD_brdf.exponent"},
    {"2/exponent", "1e7", "NEARFIELD_brdf.exponent"},
    {"2/exponent", "[2]", "NEARFIELD_brdf.exponent"},
    {"2/specular", "[0.9, 0.9, 0.9]", "diffuse + specular of at most 1"},
    {"2/specular", "[0.1, 0.1]", "NEARFIELD_brdf.specular"},
    {"2/diffuse", "[0.1, -0.1, 0]", "NEARFIELD_brdf.diffuse[1]"},
    {"2/diffuse", "0.1", "NEARFIELD_brdf.diffuse"},
    {"3/alpha", "0", "NEARFIELD_brdf.alpha"},
    {"3/alpha", "[0.1, 1.5]", "NEARFIELD_brdf.alpha[1]"},
    {"3/alpha", "[0.1, 0.1, 0.1]", "NEARFIELD_brdf.alpha"},
    {"3/exponent", "7", "'exponent'"},
    {"3/specular", "[1.1, 0, 0]", "NEARFIELD_brdf.specular[0]"},
    {"4/cosines", "[-1, -1, 1]", "'cosines'"},
    {"5/cosines", "[-1, -1, 1.5]", "NEARFIELD_brdf.cosines[2]"},
    {"5/model", "\"phong\"", "'cosines'"},
    {"6/colour", "1", "'colour'"},
};

// Proves that every rule of NEARFIELD_brdf is checked, and names the material and the member.
TEST(Scene, BrdfErrorsNameFileAndPlace) {
    const json good = document();
    for (const BadCase& bad : kBadBrdfs) {
        json changed = good;
        const std::string index(1, bad.pointer[0]);
        const std::string member(bad.pointer + 1);
        changed[json::json_pointer("/materials/" + index + "/extensions/NEARFIELD_brdf" + member)] =
            json::parse(bad.value);
        const std::string message = error_of(changed);
        EXPECT_NE(message.find("materials[" + index + "].extensions.NEARFIELD_brdf"),
                  std::string::npos)
            << bad.pointer << ": " << message;
        EXPECT_NE(message.find(bad.place), std::string::npos) << bad.pointer << ": " << message;
    }
    for (const auto& [index, member] : std::vector<std::pair<int, std::string>>{
             {2, "exponent"}, {5, "exponent"}, {5, "cosines"}, {6, "exponent"}, {3, "model"}}) {
        json changed = good;
        changed["materials"][static_cast<std::size_t>(index)]["extensions"]["NEARFIELD_brdf"].erase(
            member);
        EXPECT_NE(error_of(changed).find("NEARFIELD_brdf." + member), std::string::npos)
            << error_of(changed);
    }
    json changed = good;
    changed["extensionsUsed"] = {"NEARFIELD_luminaire"};
    EXPECT_NE(error_of(changed).find("NEARFIELD_brdf"), std::string::npos);
    changed = good;
    changed["extensionsRequired"] = {"NEARFIELD_brdf", "NEARFIELD_luminaire"};
    EXPECT_EQ(error_of(changed), "no error");
}

// Proves what a model means that names nothing but itself: glTF's own factors with that lobe.
TEST(Scene, BrdfDefaultsComeFromTheCoreMaterial) {
    json changed = document();
    json& material = changed["materials"][0];
    material["pbrMetallicRoughness"] = {{"baseColorFactor", {0.5, 0.25, 1.0, 1.0}},
                                        {"metallicFactor", 0.5},
                                        {"roughnessFactor", 0.5}};
    material["extensions"]["NEARFIELD_brdf"] = {{"model", "ggx"}};
    EXPECT_EQ(error_of(changed), "no error");
    const shared::Brdf ggx = brdf(read_scene("changed.gltf").materials[0]);
    EXPECT_EQ(ggx.kind, shared::kBrdfGgx);
    EXPECT_EQ(ggx.diffuse, glm::vec3(0.25F, 0.125F, 0.5F));
    EXPECT_NEAR(ggx.specular.x, 0.27, 1e-6);  // half of 0.04, half of the base color
    EXPECT_EQ(ggx.alpha, glm::vec2(0.25F));
    material.erase("extensions");
    EXPECT_EQ(error_of(changed), "no error");
    const shared::Brdf phong = brdf(read_scene("changed.gltf").materials[0]);
    EXPECT_EQ(phong.kind, shared::kBrdfPhong);
    EXPECT_NEAR(phong.specular.x, 0.5 * 0.04 * 0.75 + 0.25, 1e-6);
    EXPECT_NEAR(phong.exponent, (2.0 / 0.0625 - 2.0) / 4.0, 1e-5);
    material["pbrMetallicRoughness"]["roughnessFactor"] = 0.0;
    material["extensions"]["NEARFIELD_brdf"] = {{"model", "ward"}};
    EXPECT_EQ(error_of(changed), "no error");
    EXPECT_EQ(brdf(read_scene("changed.gltf").materials[0]).alpha, glm::vec2(1e-3F));
}

// Proves that tangents are read where there are normals, as glTF says, and must be one a vertex.
TEST(Scene, TangentsNeedNormals) {
    json changed = document();
    changed["meshes"][1]["primitives"][0]["attributes"].erase("NORMAL");
    EXPECT_EQ(error_of(changed), "no error");
    EXPECT_TRUE(read_scene("changed.gltf").meshes[1].tangents.empty());
    Scene scene = sample_scene();
    scene.meshes[1].tangents.pop_back();
    write_scene(scene, "tangents.gltf");
    EXPECT_NE(read_error("tangents.gltf").find("meshes[1].primitives[0].attributes.TANGENT"),
              std::string::npos);
    scene.meshes[1].tangents.assign(4, {0, 0, 2});
    write_scene(scene, "tangents.gltf");
    EXPECT_NE(read_error("tangents.gltf").find("TANGENT, element 0"), std::string::npos);
}

// Proves that a list of nodes that names one over and over is refused before it costs memory.
TEST(Scene, RepeatedNodesAreRefused) {
    json changed = document();
    changed["nodes"][0]["children"] = json(std::vector<int>(100000, 4));
    changed["scenes"][0]["nodes"] = {0};
    EXPECT_NE(error_of(changed).find("nodes[4] a second time"), std::string::npos);
}

// Proves that numbers inside buffers are checked: an index beyond the vertices, a position that is
// not a number.
TEST(Scene, BufferContentIsChecked) {
    Scene scene = sample_scene();
    scene.meshes[0].triangles[1].y = 4;
    write_scene(scene, "index.gltf");
    EXPECT_NE(read_error("index.gltf").find("meshes[0].primitives[0].indices, element 4"),
              std::string::npos);
    scene = sample_scene();
    scene.meshes[1].positions_m[2].z = std::numeric_limits<float>::quiet_NaN();
    write_scene(scene, "nan.glb");
    EXPECT_NE(read_error("nan.glb").find("meshes[1].primitives[0].attributes.POSITION, element 2"),
              std::string::npos)
        << read_error("nan.glb");
}

// Proves that small files cannot ask for large memory or deep recursion.
TEST(Scene, AmplificationAndNestingAreRefused) {
    json many = document();
    const json primitive = many["meshes"][0]["primitives"][0];
    for (int i = 0; i < 1000; ++i)
        many["meshes"][0]["primitives"].push_back(primitive);
    EXPECT_NE(error_of(many).find("over and over"), std::string::npos);
    std::ofstream("deep.gltf") << R"({"asset":{"version":"2.0"},"extras":)"
                               << std::string(100000, '[') << std::string(100000, ']') << "}";
    EXPECT_NE(read_error("deep.gltf").find("nested"), std::string::npos);
    EXPECT_NE(read_error("no such.gltf").find("no such.gltf"), std::string::npos);
}

// Proves the GLB container's checks, chunk by chunk.
TEST(Scene, BrokenGlbChunksAreRefused) {
    write_scene(sample_scene(), "whole.glb");
    std::ifstream file("whole.glb", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(file)),
                            std::istreambuf_iterator<char>());
    for (const std::size_t size :
         {std::size_t{4}, std::size_t{19}, std::size_t{24}, whole.size() / 2, whole.size() - 1}) {
        std::ofstream("cut.glb", std::ios::binary) << whole.substr(0, size);
        EXPECT_NE(read_error("cut.glb").find("cut.glb, byte"), std::string::npos) << size;
    }
    std::string chunk = whole;
    chunk[12] = '\xFF';
    chunk[15] = '\x7F';
    std::ofstream("chunk.glb", std::ios::binary) << chunk;
    EXPECT_NE(read_error("chunk.glb").find("chunk.glb, byte 12"), std::string::npos);
}

// Proves node transforms: translation, rotation, scale down a chain, and that parents come before
// children.
TEST(Scene, NodeTransformsChain) {
    json changed = document();
    changed["nodes"] = json::parse(R"([
        {"name": "parent", "translation": [1, 2, 3], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "children": [1]},
        {"name": "plate", "mesh": 0, "scale": [2, 3, 4], "translation": [10, 0, 0]}])");
    changed["scenes"][0]["nodes"] = {0};
    std::ofstream("chain.gltf") << changed.dump();
    const Scene scene = read_scene("chain.gltf");
    ASSERT_EQ(scene.instances.size(), 1U);
    const glm::dvec4 moved = scene.instances[0].world_from_mesh * glm::dvec4(1, 1, 1, 1);
    // Scaled to (2, 3, 4), moved to (12, 3, 4), turned by 90 degrees to (-3, 12, 4), moved by (1,
    // 2, 3).
    EXPECT_LT(glm::distance(glm::dvec3(moved), glm::dvec3(-2, 14, 7)), 1e-12);
}

// Proves that a scale factor is found, its sign says mirroring, and shear is refused.
TEST(Scene, UniformScaleOfAMatrix) {
    const glm::dmat4 turned = test::pose({5, 6, 7}, {1, 2, -3});
    glm::dmat4 scaled = turned;
    for (int axis = 0; axis < 3; ++axis)
        scaled[axis] *= 1e-3;
    EXPECT_NEAR(uniform_scale(scaled, ""), 1e-3, 1e-15);
    scaled[1] *= -1.0;
    EXPECT_NEAR(uniform_scale(scaled, ""), -1e-3, 1e-15);
    glm::dmat4 sheared(1.0);
    sheared[1][0] = 0.01;
    EXPECT_THROW(uniform_scale(sheared, "lamp"), Error);
    EXPECT_THROW(uniform_scale(glm::dmat4(0.0), "lamp"), Error);
}

}  // namespace
}  // namespace nearfield
