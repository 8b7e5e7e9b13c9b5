// SPDX-License-Identifier: Apache-2.0
#include "acquire/unpack.h"

#include "formats/files/error.h"

#include <gtest/gtest.h>

namespace nearfield::acquire {
namespace {

// Packs by the standard's pictures, bit for bit: bit n of pixel k goes to a place of its own. The
// oracle of unpack().
std::vector<unsigned char> packed(const PixelFormat& format,
                                  const std::vector<std::uint16_t>& values) {
    std::vector<unsigned char> bytes(
        (values.size() * static_cast<std::size_t>(format.bits_in_memory) + 7) / 8);
    const auto put = [&](std::size_t at_bit, unsigned bit) {
        bytes[at_bit / 8] = static_cast<unsigned char>(bytes[at_bit / 8] | bit << at_bit % 8);
    };
    for (std::size_t k = 0; k < values.size(); ++k)
        for (unsigned n = 0; n < static_cast<unsigned>(format.bits); ++n) {
            const unsigned bit = values[k] >> n & 1U;
            if (format.name != "Mono12Packed") {
                put(k * static_cast<std::size_t>(format.bits_in_memory) + n, bit);
                continue;
            }
            // Bytes of a pair: A11..A4 | B3..B0 A3..A0 | B11..B4.
            const std::size_t pair = k / 2 * 24;
            const bool is_second = k % 2 == 1;
            put(pair + (n >= 4 ? (is_second ? 16 : 0) + n - 4 : 8 + (is_second ? 4 : 0) + n), bit);
        }
    return bytes;
}

std::vector<std::uint16_t> mixed(std::size_t count, int bits) {
    std::vector<std::uint16_t> values;
    for (std::size_t k = 0; k < count; ++k)
        values.push_back(static_cast<std::uint16_t>((k * 2654435761U >> 7U) &
                                                    ((1U << static_cast<unsigned>(bits)) - 1)));
    return values;
}

TEST(Unpack, GivesBackWhatWasPacked) {
    for (const PixelFormat& format : pixel_formats())
        for (const glm::ivec2 size_px : {glm::ivec2(1, 1), glm::ivec2(7, 3), glm::ivec2(64, 5)}) {
            const std::vector<std::uint16_t> values =
                mixed(static_cast<std::size_t>(size_px.x * size_px.y), format.bits);
            const std::vector<unsigned char> bytes = packed(format, values);
            EXPECT_EQ(bytes.size(), byte_count(format, size_px)) << format.name;
            const capture::Frame frame = unpack(format, size_px, bytes, false);
            EXPECT_EQ(frame.values, values) << format.name;
            EXPECT_EQ(frame.bits, format.bits);
        }
}

TEST(Unpack, SwapsBytesWhereAsked) {
    const PixelFormat& format = pixel_format_of("Mono16");
    const std::vector<unsigned char> bytes = {0x12, 0x34};
    EXPECT_EQ(unpack(format, {1, 1}, bytes, false).values.front(), 0x3412);
    EXPECT_EQ(unpack(format, {1, 1}, bytes, true).values.front(), 0x1234);
}

TEST(Unpack, RefusesWhatCannotBe) {
    EXPECT_THROW(pixel_format_of("RGB8"), Error);
    const PixelFormat& format = pixel_format_of("Mono12");
    EXPECT_THROW(unpack(format, {2, 1}, std::vector<unsigned char>(3), false), Error);
    // A swapped camera's value is above the range of 12 bits: found out, not taken.
    EXPECT_THROW(unpack(format, {1, 1}, std::vector<unsigned char>{0x0F, 0xFF}, false), Error);
}

}  // namespace
}  // namespace nearfield::acquire
