// SPDX-License-Identifier: Apache-2.0
// An environment in a scene's file.
#include "formats/files/error.h"
#include "tests/render/scenes.h"
#include "tests/render/sky_scenes.h"

#include <gmock/gmock.h>

#include <fstream>
#include <string>

namespace nearfield::render {
namespace {

using test::sunny_sky, test::under;

// Proves that the extension survives a file, and that what is wrong in it is named.
TEST(SkyScene, SurvivesAFileAndRefusesNonsense) {
    Scene scene = under(sunny_sky());
    scene.environment->world_from_environment =
        glm::dmat3(test::pose({}, glm::normalize(glm::dvec3(0.3, 0.5, -0.2))));
    scene.environment->intensity = 250.0;
    write_scene(scene, "sky.gltf");
    const Scene read = read_scene("sky.gltf");
    ASSERT_TRUE(read.environment.has_value());
    EXPECT_EQ(read.environment->uri, "sunny.exr");
    EXPECT_EQ(read.environment->intensity, 250.0);
    for (int c = 0; c < 3; ++c)
        EXPECT_LT(glm::distance(read.environment->world_from_environment[c],
                                scene.environment->world_from_environment[c]),
                  1e-12);
    const auto complaint =
        [](const std::string& extension) {
            std::ofstream("bad.gltf")
                << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[],)"
                << R"("extensions":{"NEARFIELD_environment":)" << extension
                << R"(}}],"extensionsUsed":["NEARFIELD_environment"]})";
            try {
                read_scene("bad.gltf");
            } catch (const Error& error) {
                return std::string(error.what());
            }
            return std::string("none");
        };
    using testing::HasSubstr;
    EXPECT_EQ(complaint(R"({"uri":"a.hdr"})"), "none");
    EXPECT_THAT(complaint("{}"), HasSubstr(".uri"));
    EXPECT_THAT(complaint(R"({"uri":"../a.hdr","colour":1})"), HasSubstr("colour"));
    EXPECT_THAT(complaint("3"),
                HasSubstr(".NEARFIELD_environment: cannot read scene: expected an object, got 3"));
    EXPECT_THAT(complaint(R"({"uri":"/a.hdr"})"), HasSubstr("relative to the scene"));
    EXPECT_THAT(complaint(R"({"uri":"a.hdr","intensity":-1})"), HasSubstr(".intensity"));
    EXPECT_THAT(complaint(R"({"uri":"a.hdr","rotation":[0,0,1]})"), HasSubstr(".rotation"));
    EXPECT_THAT(complaint(R"({"uri":"a.hdr","rotation":[0,0,1,1]})"), HasSubstr("length 1.41"));
}

}  // namespace
}  // namespace nearfield::render
