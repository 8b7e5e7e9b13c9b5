// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/gige/gvcp.h"
#include "sample_data/gige/gvsp.h"

#include <netinet/in.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::gige {

/// Owns a UDP socket.
class UdpSocket {
  public:
    /// Binds it; port 0 takes a free one. Throws Error: `what` and why not.
    UdpSocket(std::uint32_t ip, std::uint16_t port, const std::string& what);
    ~UdpSocket();
    UdpSocket(UdpSocket&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
    UdpSocket(const UdpSocket&) = delete;
    UdpSocket& operator=(const UdpSocket&) = delete;

    int file() const { return file_; }
    std::uint16_t port() const;

    /// A datagram that is there, and whose; nothing where there is none.
    std::optional<std::pair<std::vector<std::uint8_t>, Peer>> receive() const;
    /// Sends as a camera does: nobody hears of a datagram that does not arrive.
    void send(const Packet& packet, Peer to) const;
    void send(std::span<const std::uint8_t> datagram, Peer to) const;
    /// Whether the network may cut datagrams into pieces.
    void set_do_not_fragment(bool on) const;

  private:
    int file_ = -1;
};

/// A socket for discovery by broadcast: others may bind the same; nothing where the system forbids
/// it.
std::optional<UdpSocket> broadcast_socket(std::uint16_t port);

/// The address in host byte order. Throws Error where the text is no IPv4 address.
std::uint32_t parse_ip(const std::string& text);

inline bool is_loopback(std::uint32_t ip) {
    return ip >> 24U == 127;
}

}  // namespace nearfield::gige
