// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/latlong.h"

#include "formats/files/error.h"
#include "formats/files/image.h"
#include "formats/shared/tonemap.glsl.h"
#include "tests/environment/skies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace nearfield::environment {
namespace {

void write(const LatLong& picture, const std::string& path) {
    Picture exr;
    exr.size_px = picture.size_px;
    exr.layers = {{"", {"R", "G", "B"}, {}}};
    for (const glm::vec3& rgb : picture.radiance)
        exr.layers[0].values.insert(exr.layers[0].values.end(), {rgb.r, rgb.g, rgb.b});
    write_picture(exr, std::nullopt, path);
}

std::string complaint(const std::string& path) {
    try {
        read_latlong(path);
    } catch (const Error& error) {
        return error.what();
    }
    return "none";
}

// Proves that an EXR comes back as it was written.
TEST(LatLong, ReadsExr) {
    const LatLong picture = test::sunny_sky(8);
    write(picture, "sky.exr");
    const LatLong read = read_latlong("sky.exr");
    EXPECT_EQ(read.size_px, picture.size_px);
    EXPECT_EQ(read.radiance, picture.radiance);
}

// Proves that a Radiance file's four bytes are mantissas and an exponent, rows from the top.
TEST(LatLong, ReadsRadiance) {
    std::ofstream file("sky.hdr", std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
    for (int k = 0; k < 8; ++k) {
        const char exponent = static_cast<char>(k < 4 ? 129 : 138);  // times 2^(e - 136)
        const char bytes[4] = {static_cast<char>(128), 64, static_cast<char>(16 * k), exponent};
        file.write(bytes, 4);
    }
    file.close();
    const LatLong picture = read_latlong("sky.hdr");
    ASSERT_EQ(picture.size_px, glm::ivec2(4, 2));
    EXPECT_NEAR(picture.radiance[1].r, 1.0F, 0.005F);  // half a step of the mantissa
    EXPECT_NEAR(picture.radiance[1].g, 0.5F, 0.005F);
    EXPECT_NEAR(picture.radiance[5].r, 512.0F, 2.5F);
    EXPECT_NEAR(picture.radiance[2].b, 0.25F, 0.005F);
}

// Proves that what is no environment is refused, with the place.
TEST(LatLong, RefusesWhatIsNone) {
    using testing::HasSubstr;
    EXPECT_THAT(complaint("sky.png"), HasSubstr(".hdr or .exr"));
    EXPECT_THAT(complaint("absent.hdr"), HasSubstr("absent.hdr"));
    std::ofstream("text.hdr") << "not a picture";
    EXPECT_THAT(complaint("text.hdr"), HasSubstr("text.hdr"));
    LatLong bad = test::sunny_sky(8);
    bad.radiance[bad.index({3, 5})].g = std::numeric_limits<float>::quiet_NaN();
    write(bad, "bad.exr");
    EXPECT_THAT(complaint("bad.exr"), HasSubstr("column 3, row 5"));
    bad.radiance[bad.index({3, 5})].g = -1.0F;
    write(bad, "bad.exr");
    EXPECT_THAT(complaint("bad.exr"), HasSubstr(">= 0"));
    LatLong square = test::sunny_sky(8);
    square.size_px = {8, 8};
    square.radiance.resize(64);
    write(square, "square.exr");
    EXPECT_THAT(complaint("square.exr"), HasSubstr("twice as wide as high"));
}

// Proves that pixels' solid angles are the sphere, poles included.
TEST(LatLong, PixelsFillTheSphere) {
    const LatLong picture = test::sunny_sky(512);
    double sum = 0.0;
    for (int y = 0; y < 512; ++y)
        sum += 1024 * pixel_sr(picture, y);
    EXPECT_NEAR(sum, 4.0 * std::acos(-1.0), 1e-12);
    EXPECT_GT(pixel_sr(picture, 0), 0.0);
}

// Proves that real pictures are read: facts that are known of them. Skipped where they are absent.
TEST(LatLong, ReadsRealPictures) {
    const std::string folder = NEARFIELD_SOURCE_DIR "/../shared/data/hdr/";
    if (!std::filesystem::exists(folder + "grace.hdr"))
        GTEST_SKIP() << "no " << folder << "grace.hdr";
    const LatLong grace = read_latlong(folder + "grace.hdr");
    EXPECT_EQ(grace.size_px, glm::ivec2(256, 128));
    float largest = 0.0F;
    double sum = 0.0;
    for (const glm::vec3& rgb : grace.radiance) {
        largest = std::max(largest, shared::luminance709(rgb));
        sum += static_cast<double>(shared::luminance709(rgb));
    }
    EXPECT_NEAR(largest, 2177.0F, 0.5F);
    EXPECT_NEAR(sum / static_cast<double>(grace.radiance.size()), 0.42, 0.005);
}

}  // namespace
}  // namespace nearfield::environment
