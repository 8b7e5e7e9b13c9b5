// SPDX-License-Identifier: Apache-2.0
/// The stream protocol: a frame as a leader, data packets and a trailer. No sockets.
#pragma once

#include "sample_data/gige/device.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace nearfield::gige {

/// Headers of IP, UDP and GVSP within a packet's size.
inline constexpr std::uint32_t kIpUdpBytes = 28, kGvspBytes = 8;

/// A frame that is or was sent.
struct Block {
    std::uint16_t id = 1;  // 1 ... 65535, then 1 again
    std::uint64_t timestamp_ns = 0;
    Settings settings;
    std::vector<std::uint8_t> payload;

    std::uint32_t data_bytes() const { return settings.packet_bytes - kIpUdpBytes - kGvspBytes; }
    std::uint32_t data_packets() const {
        return static_cast<std::uint32_t>((payload.size() + data_bytes() - 1) / data_bytes());
    }
    /// Leader, data, trailer; packet ids are 0 ... packets() - 1.
    std::uint32_t packets() const { return data_packets() + 2; }
};

/// The id after `id`: zero is reserved for test packets.
std::uint16_t next_block_id(std::uint16_t id);

/// A datagram in two pieces, so that a frame's bytes are not copied.
struct Packet {
    std::array<std::uint8_t, 44> head{};
    std::uint32_t head_bytes = 0;
    std::span<const std::uint8_t> data;  // into the block

    std::size_t bytes() const { return head_bytes + data.size(); }
};

/// Packet `packet_id` of the block, marked where it is sent again.
Packet packet_of(const Block& block, std::uint32_t packet_id, bool is_resent);

/// What is sent in place of a packet that is gone.
Packet unavailable_packet(std::uint16_t block_id, std::uint32_t packet_id);

/// A datagram that makes an IP packet of packet_bytes.
std::vector<std::uint8_t> test_packet(std::uint32_t packet_bytes);

}  // namespace nearfield::gige
