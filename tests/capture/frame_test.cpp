// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/frame.h"

#include "formats/files/error.h"

#include <gtest/gtest.h>

namespace nearfield::capture {
namespace {

Frame ramp(glm::ivec2 size_px, int channels, int bits) {
    Frame frame;
    frame.size_px = size_px;
    frame.channels = channels;
    frame.bits = bits;
    const auto count = static_cast<unsigned>(size_px.x * size_px.y * channels);
    for (unsigned k = 0; k < count; ++k)
        frame.values.push_back(
            static_cast<std::uint16_t>((k * 40503U) & static_cast<unsigned>(frame.range_dn())));
    return frame;
}

TEST(Frame, SurvivesItsFile) {
    for (const int bits : {8, 10, 12, 16})
        for (const int channels : {1, 3})
            for (const glm::ivec2 size_px :
                 {glm::ivec2(1, 1), glm::ivec2(7, 5), glm::ivec2(300, 219)}) {
                const Frame frame = ramp(size_px, channels, bits);
                const Frame back = decode_frame(encode_frame(frame), bits, "x.png");
                EXPECT_EQ(back.values, frame.values);
                EXPECT_EQ(back.size_px, frame.size_px);
                EXPECT_EQ(back.channels, channels);
            }
}

// Every one of the 65536 values, in case some gamma were applied on the way.
TEST(Frame, KeepsEveryValue) {
    Frame frame;
    frame.size_px = {256, 256};
    for (int value = 0; value < 65536; ++value)
        frame.values.push_back(static_cast<std::uint16_t>(value));
    EXPECT_EQ(decode_frame(encode_frame(frame), 16, "x.png").values, frame.values);
}

TEST(Frame, MeasuresItsLevels) {
    Frame frame;
    frame.size_px = {4, 1};
    frame.bits = 8;
    frame.values = {3, 255, 255, 7};
    const FrameLevels levels = levels_of(frame);
    EXPECT_EQ(levels.least_dn, 3);
    EXPECT_EQ(levels.most_dn, 255);
    EXPECT_DOUBLE_EQ(levels.mean_dn, 130);
    EXPECT_DOUBLE_EQ(levels.share_saturated, 0.5);
}

TEST(Frame, RefusesDamage) {
    const std::string png = encode_frame(ramp({32, 32}, 1, 12));
    EXPECT_THROW(decode_frame("", 12, "x.png"), Error);
    EXPECT_THROW(decode_frame(png.substr(0, png.size() / 2), 12, "x.png"), Error);
    EXPECT_THROW(decode_frame(png, 8, "x.png"), Error);  // values above the range
    Frame wrong = ramp({32, 32}, 1, 12);
    wrong.values.pop_back();
    EXPECT_THROW(encode_frame(wrong), Error);
}

}  // namespace
}  // namespace nearfield::capture
