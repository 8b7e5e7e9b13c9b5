// SPDX-License-Identifier: Apache-2.0
// Saving: what the file holds beside lamps is kept, known to this project or not.
#include "app/viewer/files.h"

#include "app/viewer/history.h"
#include "formats/files/error.h"
#include "tests/render/scenes.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

namespace nearfield::viewer {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json read_json(const std::string& path) {
    std::ifstream stream(path);
    return json::parse(stream);
}

/// A scene whose lamp hangs below a turned and moved node, with much that nobody here reads.
std::string write_foreign_scene(const std::string& path) {
    Scene scene = test::uneven_scene();
    write_scene(scene, path);
    json document = read_json(path);
    document["asset"]["copyright"] = "somebody";
    document["extras"] = {{"project", 17}};
    document["animations"] = json::array({{{"name", "swing"}, {"channels", json::array()}}});
    document["extensionsUsed"].push_back("VENDOR_fog");
    document["extensions"]["VENDOR_fog"] = {{"density", 0.25}};
    std::size_t lamp = 0;
    while (!document["nodes"][lamp].contains("extensions"))
        ++lamp;
    document["nodes"][lamp]["extras"] = "keep me";
    document["nodes"][lamp]["extensions"]["VENDOR_pole"] = {{"height", 8}};
    document["nodes"][lamp]["extensions"]["NEARFIELD_luminaire"]["extras"] = {{"serial", "A1"}};
    const std::size_t pole = document["nodes"].size();
    document["nodes"].push_back({{"name", "pole"},
                                 {"translation", {0.5, 0.0, 0.25}},
                                 {"rotation", {0.0, 0.0, 0.7071067811865476, 0.7071067811865476}},
                                 {"children", {lamp}}});
    for (json& node : document["scenes"][0]["nodes"])
        if (node == lamp)
            node = pole;
    std::ofstream(path) << document.dump();
    return path;
}

double distance(const glm::dmat4& a, const glm::dmat4& b) {
    double sum = 0.0;
    for (int c = 0; c < 4; ++c)
        sum += glm::length(a[c] - b[c]);
    return sum;
}

TEST(ViewerFiles, WhatNobodyReadsIsKept) {
    const std::string path = write_foreign_scene("foreign.gltf");
    const json before = read_json(path);
    Document document = open_document(path).document;
    glm::dmat4 pose = document.lamps[0].luminaire.world_from_luminaire;
    pose[3] += glm::dvec4(0.1, 0.2, 0.3, 0.0);
    document = edited(document, SetPose{0, pose});
    document = edited(document, SetDim{0, 0.4});
    document = edited(document, SetTint{0, {1.0F, 0.5F, 0.25F}});
    save_document(document, path);

    const json after = read_json(path);
    for (const char* key :
         {"asset", "extras", "animations", "extensions", "meshes", "materials", "buffers",
          "bufferViews", "accessors", "cameras", "scenes", "extensionsUsed"})
        EXPECT_EQ(after[key], before[key]) << key;
    const json* lamp = nullptr;
    for (const json& node : after["nodes"])
        if (node.contains("extensions"))
            lamp = &node;
    ASSERT_NE(lamp, nullptr);
    EXPECT_EQ((*lamp)["extras"], "keep me");
    EXPECT_EQ((*lamp)["extensions"]["VENDOR_pole"]["height"], 8);
    EXPECT_EQ((*lamp)["extensions"]["NEARFIELD_luminaire"]["extras"]["serial"], "A1");

    const Document again = open_document(path).document;
    ASSERT_EQ(again.lamps.size(), 1U);
    EXPECT_LT(distance(again.lamps[0].luminaire.world_from_luminaire, pose), 1e-9);
    EXPECT_EQ(again.lamps[0].luminaire.dim, 0.4);
    EXPECT_EQ(again.lamps[0].luminaire.tint, glm::vec3(1.0F, 0.5F, 0.25F));
}

// Nothing edited: only the way numbers and spaces are written may differ.
TEST(ViewerFiles, SavedAsItWasIsAsItWas) {
    const std::string path = write_foreign_scene("unchanged.gltf");
    const json before = read_json(path);
    save_document(open_document(path).document, path);
    EXPECT_EQ(read_json(path), before);
}

TEST(ViewerFiles, LampsComeAndGo) {
    const std::string path = write_foreign_scene("come_and_go.gltf");
    Document document = open_document(path).document;
    document = edited(document, Duplicate{0, {1.0, 0.0, 0.0}});
    Camera camera = document.scene->cameras.front();
    camera.name = "mine";
    document = edited(document, AddBookmark{camera});
    document = save_document(document, path);
    EXPECT_GE(document.lamps[1].luminaire.node, 0);
    Scene scene = read_scene(path);
    ASSERT_EQ(scene.luminaires.size(), 2U);
    EXPECT_EQ(scene.cameras.back().name, "mine");
    const std::size_t cameras = scene.cameras.size();
    document = edited(document, Remove{0});
    document = save_document(document, path);
    scene = read_scene(path);
    ASSERT_EQ(scene.luminaires.size(), 1U);
    EXPECT_EQ(scene.luminaires[0].name, document.lamps[0].luminaire.name);
    EXPECT_EQ(scene.cameras.size(), cameras);  // a bookmark is saved once
}

TEST(ViewerFiles, ScenesInAnotherFolderStillFindTheirFiles) {
    const std::string path = write_foreign_scene("here.gltf");
    Scene scene = read_scene(path);
    write_scene(scene, "side_file.gltf", BufferPlace::SideFile);
    fs::create_directories("sub folder/deep");
    const std::string moved = "sub folder/deep/there.gltf";
    save_document(open_document("side_file.gltf").document, moved);
    scene = read_scene(moved);
    ASSERT_EQ(scene.luminaires.size(), 1U);
    EXPECT_TRUE(fs::exists(scene.luminaires[0].path)) << scene.luminaires[0].path;
    EXPECT_EQ(scene.meshes.size(), read_scene("side_file.gltf").meshes.size());
}

TEST(ViewerFiles, BinaryScenesKeepTheirBuffer) {
    write_scene(test::uneven_scene(), "binary.glb");
    Document document = open_document("binary.glb").document;
    save_document(edited(document, SetOn{0, false}), "binary.glb");
    const Scene scene = read_scene("binary.glb");
    EXPECT_FALSE(scene.luminaires[0].on);
    EXPECT_EQ(scene.meshes[0].positions_m, test::uneven_scene().meshes[0].positions_m);
}

TEST(ViewerFiles, ALuminaireIsShownInASceneThatCanBeSaved) {
    const std::string lamp = test::uneven_scene().luminaires[0].path;
    const Document document = open_document(lamp).document;
    EXPECT_TRUE(document.path.empty());
    ASSERT_EQ(document.lamps.size(), 1U);
    save_document(document, "stock.gltf");
    const Scene scene = read_scene("stock.gltf");
    ASSERT_EQ(scene.luminaires.size(), 1U);
    EXPECT_TRUE(fs::equivalent(scene.luminaires[0].path, lamp));
}

TEST(ViewerFiles, ATintThatIsNoneIsRefused) {
    const std::string path = write_foreign_scene("tint.gltf");
    for (const json& tint : {json(1.0), json({1.0, 0.5}), json({1.0, 0.5, -0.1}),
                             json({1.0, 0.5, 1.1}), json({"a", "b", "c"})}) {
        json document = read_json(path);
        for (json& node : document["nodes"])
            if (node.contains("extensions"))
                node["extensions"]["NEARFIELD_luminaire"]["tint"] = tint;
        std::ofstream("bad_tint.gltf") << document.dump();
        EXPECT_THROW(read_scene("bad_tint.gltf"), Error) << tint;
    }
}

}  // namespace
}  // namespace nearfield::viewer
