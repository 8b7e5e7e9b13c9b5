// SPDX-License-Identifier: Apache-2.0
#include "fit/texel_spool.h"

#include "formats/files/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace nearfield::fit {
namespace {

constexpr glm::ivec2 kTexels{5, 4};

// Every number says what and where it is.
RectifiedImage numbered(int position, int channel) {
    RectifiedImage image;
    for (int t = 0; t < kTexels.x * kTexels.y; ++t) {
        image.value.push_back(static_cast<float>(1000 * channel + 100 * position + t));
        image.variance.push_back(image.value.back() + 0.5F);
    }
    return image;
}

// Proves that rows come back channel by channel and position by position, in whatever order they
// were written, and that a position that never came is missing.
TEST(TexelSpool, RowsComeBack) {
    TexelSpool written(".", kTexels, 2, 3);
    for (const auto& [position, channel] :
         {std::pair(2, 1), std::pair(0, 0), std::pair(0, 1), std::pair(2, 0)})
        written.put(position, channel, numbered(position, channel));
    const TexelSpool spool = std::move(written);
    const TileInput tile = spool.read({1, 2});
    ASSERT_EQ(tile.value.size(), 2U * 3U * 10U);
    for (int channel = 0; channel < 2; ++channel)
        for (int position = 0; position < 3; ++position)
            for (int t = 0; t < 10; ++t) {
                const auto at = static_cast<std::size_t>((channel * 3 + position) * 10 + t);
                if (position == 1) {
                    EXPECT_TRUE(std::isinf(tile.variance[at]));
                    continue;
                }
                EXPECT_EQ(tile.value[at],
                          static_cast<float>(1000 * channel + 100 * position + 5 + t));
                EXPECT_EQ(tile.variance[at], tile.value[at] + 0.5F);
            }
}

// Proves that no name is left behind, while it lives or after.
TEST(TexelSpool, HasNoName) {
    std::filesystem::create_directory("spool_folder");
    TexelSpool spool("spool_folder", kTexels, 1, 1);
    spool.put(0, 0, numbered(0, 0));
    EXPECT_TRUE(std::filesystem::is_empty("spool_folder"));
}

TEST(TexelSpool, AFolderThatIsNotThereIsNamed) {
    try {
        const TexelSpool spool("no_such_folder", kTexels, 1, 1);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_THAT(error.where, testing::HasSubstr("no_such_folder"));
    }
}

}  // namespace
}  // namespace nearfield::fit
