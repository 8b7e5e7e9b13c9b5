// SPDX-License-Identifier: Apache-2.0
// The glTF proxy is a scene that our own reader finds the near-field lamp in, and its point light
// is turned so that the table's directions are the luminaire's.
#include "formats/proxies/far_field_scene.h"

#include "formats/files/atomic_file.h"
#include "formats/scene/scene.h"

#include <glm/gtc/quaternion.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace nearfield {
namespace {

const proxies::FarFieldProxy kProxy{"lamp.luminaire.exr", "lamp.ies", {0.1, 0.2, -0.3}, 1000};

TEST(GltfProxy, IsASceneWithTheNearFieldLamp) {
    write_file(proxies::gltf_proxy(kProxy), "proxy.gltf");
    write_file("", "lamp.luminaire.exr");
    const Scene scene = read_scene("proxy.gltf");
    ASSERT_EQ(scene.luminaires.size(), 1U);
    EXPECT_THAT(scene.luminaires[0].path, testing::EndsWith("lamp.luminaire.exr"));
    EXPECT_EQ(scene.luminaires[0].world_from_luminaire, glm::dmat4(1.0));
}

TEST(GltfProxy, TurnsTheProfileToTheLuminaire) {
    const auto json = nlohmann::json::parse(proxies::gltf_proxy(kProxy));
    const auto& node = json["nodes"][1];
    EXPECT_EQ(node["extensions"]["EXT_lights_ies"]["light"], 0);
    EXPECT_EQ(json["extensions"]["EXT_lights_ies"]["lights"][0]["uri"], "lamp.ies");
    EXPECT_EQ(json["nodes"][0]["children"], nlohmann::json::array({1}));
    const std::vector<double> q = node["rotation"];
    const glm::dquat turn(q[3], q[0], q[1], q[2]);
    // The profile's zero is -z, its C0 +x, its C90 +y, counterclockwise about +z; the table's own
    // are +z, +x and -y of the luminaire.
    EXPECT_LT(glm::length(turn * glm::dvec3(0, 0, -1) - glm::dvec3(0, 0, 1)), 1e-12);
    EXPECT_LT(glm::length(turn * glm::dvec3(1, 0, 0) - glm::dvec3(1, 0, 0)), 1e-12);
    EXPECT_LT(glm::length(turn * glm::dvec3(0, 1, 0) - glm::dvec3(0, -1, 0)), 1e-12);
}

TEST(UsdProxy, NamesBothFiles) {
    const std::string text = proxies::usd_proxy(kProxy);
    EXPECT_TRUE(text.starts_with("#usda 1.0"));
    EXPECT_THAT(text, testing::HasSubstr("@lamp.luminaire.exr@"));
    EXPECT_THAT(text, testing::HasSubstr("shaping:ies:file = @lamp.ies@"));
    EXPECT_EQ(std::count(text.begin(), text.end(), '{'), std::count(text.begin(), text.end(), '}'));
}

}  // namespace
}  // namespace nearfield
