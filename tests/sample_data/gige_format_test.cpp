// SPDX-License-Identifier: Apache-2.0
// Proves that pixels get the bytes that the naming convention says, bit by bit, and that regions
// are cut out where they should be. Does not prove that clients read them so: gige_wire_test.
#include "sample_data/gige/pixel_format.h"

#include <gtest/gtest.h>

#include <random>

namespace nearfield::gige {
namespace {

std::vector<std::uint16_t> random_values(std::size_t count, int bits, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::uint16_t> values(count);
    for (std::uint16_t& value : values)
        value = static_cast<std::uint16_t>(random() & ((1U << bits) - 1));
    return values;
}

// Bit `bit` of pixel k, and where the layout puts it: byte and bit within it.
struct Place {
    std::size_t byte = 0;
    int bit = 0;
};

// From the convention's drawings, one bit at a time.
Place place_of(PixelFormat format, std::size_t k, int bit) {
    const auto b = static_cast<std::size_t>(bit);
    switch (format) {
        case PixelFormat::Mono8:
        case PixelFormat::BayerRG8:
            return {k, bit};
        case PixelFormat::Mono12p:
            return {(12 * k + b) / 8, static_cast<int>((12 * k + b) % 8)};
        case PixelFormat::Mono12Packed:
            if (bit >= 4)
                return {3 * (k / 2) + (k % 2 == 0 ? 0U : 2U), bit - 4};
            return {3 * (k / 2) + 1, k % 2 == 0 ? bit : bit + 4};
        default:
            return {2 * k + b / 8, bit % 8};
    }
}

class EveryFormat : public testing::TestWithParam<FormatInfo> {};

TEST_P(EveryFormat, PutsEveryBitWhereTheConventionSays) {
    const FormatInfo info = GetParam();
    for (const std::size_t count : {2U, 64U, 7U, 1U}) {
        const auto values = random_values(count, info.value_bits, 5);
        const auto bytes = pack(info.format, values);
        ASSERT_EQ(bytes.size(), payload_bytes(info.format, {static_cast<int>(count), 1}));
        std::vector<std::uint8_t> used(bytes.size());
        for (std::size_t k = 0; k < count; ++k)
            for (int bit = 0; bit < info.value_bits; ++bit) {
                const Place place = place_of(info.format, k, bit);
                ASSERT_LT(place.byte, bytes.size());
                ASSERT_EQ(bytes[place.byte] >> place.bit & 1, values[k] >> bit & 1)
                    << info.name << " pixel " << k << " bit " << bit;
                ASSERT_EQ(used[place.byte] >> place.bit & 1, 0);
                used[place.byte] = static_cast<std::uint8_t>(used[place.byte] | 1U << place.bit);
            }
        for (std::size_t k = 0; k < bytes.size(); ++k)
            EXPECT_EQ(bytes[k] & ~used[k], 0) << "bits that belong to no pixel are zero";
    }
}

TEST_P(EveryFormat, IsFoundByItsCode) {
    const auto code = static_cast<std::uint32_t>(GetParam().format);
    ASSERT_TRUE(format_info(code));
    EXPECT_STREQ(format_info(code)->name, GetParam().name);
    EXPECT_FALSE(format_info(code ^ 0x80U));
}

INSTANTIATE_TEST_SUITE_P(GigePixels, EveryFormat, testing::ValuesIn(kFormats), [](const auto& one) {
    return std::string(one.param.name);
});

TEST(GigeCrop, TakesTheRegionAndShiftsBits) {
    const glm::ivec2 sensor_px(10, 8), offset_px(4, 2), size_px(6, 4);
    const auto values = random_values(80, 12, 9);
    for (const int bits : {8, 10, 12, 16}) {
        const auto region = crop(values, sensor_px, offset_px, size_px, 12, bits);
        ASSERT_EQ(region.size(), 24U);
        for (int y = 0; y < size_px.y; ++y)
            for (int x = 0; x < size_px.x; ++x) {
                const int value = values[static_cast<std::size_t>((y + 2) * 10 + x + 4)];
                const int expected =
                    bits < 12 ? value / (1 << (12 - bits)) : value * (1 << (bits - 12));
                EXPECT_EQ(region[static_cast<std::size_t>(y * 6 + x)], expected);
            }
    }
}

}  // namespace
}  // namespace nearfield::gige
