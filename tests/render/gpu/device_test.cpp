// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "render/gpu/storage.h"
#include "tests/render/gpu/gl_fixture.h"

#include <gmock/gmock.h>

#include <numeric>

namespace nearfield::render::gpu {
namespace {

class DeviceTest : public GlTest {};

TEST_F(DeviceTest, KnowsItsLimits) {
    EXPECT_FALSE(device().renderer().empty());
    EXPECT_GE(device().max_texture_px(), 16384);  // of OpenGL 4.5
    EXPECT_GE(device().max_layers(), 2048);
}

TEST_F(DeviceTest, ReportsTheDriversErrorWithThePass) {
    try {
        device().run_pass("shading", [] { glBindTextureUnit(~0U, 0); });
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_THAT(error.where, testing::HasSubstr("pass 'shading'"));
        EXPECT_FALSE(error.got.empty());
    }
    EXPECT_NO_THROW(device().check("after"));  // an error is reported once
}

TEST_F(DeviceTest, CostsArePassesInOrderWithWhatTheyAllocate) {
    device().clear_costs();
    Texture texture;
    device().run_pass("first", [&] { texture = make_texture(device(), "t", GL_RG32F, {16, 8}); });
    device().run_pass("second", [] {});
    ASSERT_EQ(device().costs().size(), 2U);
    EXPECT_EQ(device().costs()[0].name, "first");
    EXPECT_EQ(device().costs()[0].bytes, 16U * 8U * 8U);
    EXPECT_EQ(device().costs()[1].bytes, 0U);
    EXPECT_GT(device().costs()[0].time_s, 0.0);
}

TEST_F(DeviceTest, RefusesWhatPassesTheLimitsWithNumbers) {
    try {
        make_texture_array(device(), "a lamp's images", GL_R32F, {8, 8}, device().max_layers() + 1);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.where, "a lamp's images");
        EXPECT_THAT(error.expected, testing::HasSubstr(std::to_string(device().max_layers())));
    }
}

// 16 TiB: refused before or by the driver, with the pass and the bytes.
TEST_F(DeviceTest, NamesWhatItHasNoMemoryFor) {
    try {
        device().run_pass("shading", [&] {
            make_texture_array(device(), "a lamp's images", GL_RG32F,
                               glm::ivec2(device().max_texture_px()), device().max_layers());
        });
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_THAT(error.what_, testing::HasSubstr("out of graphics memory"));
        EXPECT_THAT(error.where, testing::HasSubstr("a lamp's images in pass 'shading' on "));
        EXPECT_THAT(error.expected + error.got, testing::HasSubstr("4194304.0 MiB"));
    }
    // The pass is over.
    EXPECT_THROW(make_texture_array(device(), "t", GL_R32F, {8, 8}, 1 << 20), Error);
    EXPECT_NO_THROW(make_texture(device(), "t", GL_R32F, {8, 8}));
}

// The driver's own word for it, which a device without the machine's memory has alone.
TEST_F(DeviceTest, SaysWhatTheDriverHadNoRoomFor) {
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
    const Texture texture(id);
    glTextureStorage3D(id, 1, GL_RGBA32F, device().max_texture_px(), device().max_texture_px(),
                       device().max_layers());
    try {
        device().check_allocation("a lamp's images", std::uint64_t{3} << 20U);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.what_, "out of graphics memory");
        EXPECT_THAT(error.where, testing::HasSubstr("a lamp's images on "));
        EXPECT_THAT(error.expected, testing::HasSubstr("room for 3.0 MiB beside "));
        EXPECT_THAT(error.got, testing::HasSubstr("out of memory"));
    }
    EXPECT_NO_THROW(device().check("after"));
}

TEST_F(DeviceTest, RefusesBuffersThatShadersCannotRead) {
    try {
        make_zero_buffer(device(), device().max_buffer_bytes() + 1, "energies");
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.where, "energies");
        EXPECT_EQ(error.got, std::to_string(device().max_buffer_bytes() + 1));
    }
}

TEST_F(DeviceTest, TexturesKeepFloatsBitForBit) {
    std::vector<float> values(std::size_t{5} * 3);
    std::iota(values.begin(), values.end(), 1.0e-30F);
    values[7] = 3.3e38F;
    const Texture texture = make_texture(device(), "t", GL_R32F, {5, 3});
    upload(texture, {5, 3}, 1, values.data());
    EXPECT_EQ(read_back(texture, {5, 3}, 1), values);
}

TEST_F(DeviceTest, BuffersKeepTheirBytes) {
    const std::vector<glm::ivec4> values = {{1, 2, 3, 4}, {5, 6, 7, 8}};
    const Buffer buffer = make_buffer_of(device(), values);
    EXPECT_EQ(read_buffer<glm::ivec4>(buffer, 2), values);
    EXPECT_EQ(read_buffer<float>(make_zero_buffer(device(), 8), 2),
              (std::vector<float>{0.0F, 0.0F}));
}

}  // namespace
}  // namespace nearfield::render::gpu
