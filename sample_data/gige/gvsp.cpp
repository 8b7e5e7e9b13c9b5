// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/gvsp.h"

#include "sample_data/gige/bytes.h"

#include <algorithm>

namespace nearfield::gige {
namespace {

constexpr std::uint32_t kLeader = 1U << 24U, kTrailer = 2U << 24U, kData = 3U << 24U;
constexpr std::uint32_t kResentStatus = 0x0100;
constexpr std::uint32_t kImage = 1;  // payload type

std::uint8_t* put_header(Packet& packet,
                         std::uint32_t status,
                         std::uint16_t block_id,
                         std::uint32_t type_and_packet_id) {
    put_u16(packet.head.data(), status);
    put_u16(&packet.head[2], block_id);
    put_u32(&packet.head[4], type_and_packet_id);
    packet.head_bytes = kGvspBytes;
    return &packet.head[kGvspBytes];
}

void put_leader(Packet& packet, std::uint8_t* to, const Block& block) {
    const Settings& settings = block.settings;
    put_u16(to + 2, kImage);
    put_u64(to + 4, block.timestamp_ns);
    put_u32(to + 12, static_cast<std::uint32_t>(settings.format));
    put_u32(to + 16, static_cast<std::uint32_t>(settings.size_px.x));
    put_u32(to + 20, static_cast<std::uint32_t>(settings.size_px.y));
    put_u32(to + 24, static_cast<std::uint32_t>(settings.offset_px.x));
    put_u32(to + 28, static_cast<std::uint32_t>(settings.offset_px.y));
    packet.head_bytes += 36;  // ends with two paddings of 0
}

void put_trailer(Packet& packet, std::uint8_t* to, const Block& block) {
    put_u16(to + 2, kImage);
    put_u32(to + 4, static_cast<std::uint32_t>(block.settings.size_px.y));
    packet.head_bytes += 8;
}

}  // namespace

std::uint16_t next_block_id(std::uint16_t id) {
    return id == 0xFFFF ? std::uint16_t{1} : static_cast<std::uint16_t>(id + 1);
}

Packet packet_of(const Block& block, std::uint32_t packet_id, bool is_resent) {
    const bool is_leader = packet_id == 0, is_trailer = packet_id + 1 == block.packets();
    const std::uint32_t type = is_leader ? kLeader : is_trailer ? kTrailer : kData;
    Packet packet;
    std::uint8_t* after =
        put_header(packet, is_resent ? kResentStatus : 0, block.id, type | packet_id);
    if (is_leader) {
        put_leader(packet, after, block);
    } else if (is_trailer) {
        put_trailer(packet, after, block);
    } else {
        const std::size_t from = std::size_t{packet_id - 1} * block.data_bytes();
        packet.data = std::span(block.payload)
                          .subspan(from, std::min<std::size_t>(block.data_bytes(),
                                                               block.payload.size() - from));
    }
    return packet;
}

Packet unavailable_packet(std::uint16_t block_id, std::uint32_t packet_id) {
    Packet packet;
    put_header(packet, static_cast<std::uint32_t>(Status::PacketUnavailable), block_id,
               kData | packet_id);
    return packet;
}

std::vector<std::uint8_t> test_packet(std::uint32_t packet_bytes) {
    return std::vector<std::uint8_t>(packet_bytes - kIpUdpBytes);
}

}  // namespace nearfield::gige
