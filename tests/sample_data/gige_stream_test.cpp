// SPDX-License-Identifier: Apache-2.0
// Proves how a frame becomes packets, by the standard's numbers.
#include "sample_data/gige/gvsp.h"
#include "tests/sample_data/gige_commands.h"

#include <gtest/gtest.h>

#include <numeric>

namespace nearfield::gige {
namespace {

Block sample_block(std::uint32_t packet_bytes, std::size_t payload) {
    Block block;
    block.id = 0xBEEF;
    block.timestamp_ns = 0x0102030405060708;
    block.settings.packet_bytes = packet_bytes;
    block.settings.format = PixelFormat::Mono12p;
    block.settings.size_px = {640, 480};
    block.settings.offset_px = {16, 32};
    block.payload.resize(payload);
    std::iota(block.payload.begin(), block.payload.end(), std::uint8_t{1});
    return block;
}

Bytes datagram(const Packet& packet) {
    Bytes bytes(packet.head.begin(), packet.head.begin() + packet.head_bytes);
    bytes.insert(bytes.end(), packet.data.begin(), packet.data.end());
    return bytes;
}

TEST(GigeStream, PacketsHoldTheFrameInOrder) {
    for (const std::uint32_t packet_bytes : {220U, 1500U, 9000U})
        for (const std::size_t payload : {1U, 183U, 184U, 185U, 8964U, 100000U}) {
            const Block block = sample_block(packet_bytes, payload);
            Bytes together;
            for (std::uint32_t k = 1; k + 1 < block.packets(); ++k) {
                const Bytes bytes = datagram(packet_of(block, k, false));
                ASSERT_LE(bytes.size() + 28, packet_bytes);
                EXPECT_EQ(number(bytes, 0, 2), 0U);
                EXPECT_EQ(number(bytes, 2, 2), 0xBEEFU);
                EXPECT_EQ(number(bytes, 4, 4), 0x03000000U + k);
                together.insert(together.end(), bytes.begin() + 8, bytes.end());
            }
            EXPECT_EQ(together, block.payload);
        }
}

TEST(GigeStream, LeaderAndTrailerDescribeTheFrame) {
    const Block block = sample_block(1500, 5000);
    const Bytes leader = datagram(packet_of(block, 0, false));
    ASSERT_EQ(leader.size(), 44U);
    const std::vector<std::uint32_t> expected = {
        0x0000BEEF, 0x01000000, 1, 0x01020304, 0x05060708, 0x010C0047, 640, 480, 16, 32, 0};
    for (std::size_t k = 0; k < expected.size(); ++k)
        EXPECT_EQ(number(leader, 4 * k, 4), expected[k]) << "word " << k;
    ASSERT_EQ(block.packets(), 6U);  // 1464 bytes a packet
    const Bytes trailer = datagram(packet_of(block, 5, true));
    ASSERT_EQ(trailer.size(), 16U);
    EXPECT_EQ(number(trailer, 0, 4), 0x0100BEEFU) << "sent again";
    EXPECT_EQ(number(trailer, 4, 4), 0x02000005U);
    EXPECT_EQ(number(trailer, 12, 4), 480U);
}

TEST(GigeStream, BlockIdsLeaveZeroOut) {
    EXPECT_EQ(next_block_id(1), 2);
    EXPECT_EQ(next_block_id(65534), 65535);
    EXPECT_EQ(next_block_id(65535), 1);
}

TEST(GigeStream, ATestPacketHasItsSize) {
    EXPECT_EQ(test_packet(1500).size(), 1472U);
}

}  // namespace
}  // namespace nearfield::gige
