// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/udp_socket.h"

#include "formats/files/error.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>

namespace nearfield::gige {
namespace {

sockaddr_in address_of(Peer peer) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(peer.port);
    address.sin_addr.s_addr = htonl(peer.ip);
    return address;
}

std::string dotted(std::uint32_t ip) {
    return fmt::format("{}.{}.{}.{}", ip >> 24U, ip >> 16U & 0xFFU, ip >> 8U & 0xFFU, ip & 0xFFU);
}

// The system's calls take all kinds of addresses through one type.
const sockaddr* generic(const sockaddr_in& address) {
    return reinterpret_cast<const sockaddr*>(&address);
}

}  // namespace

UdpSocket::UdpSocket(std::uint32_t ip, std::uint16_t port, const std::string& what)
    : file_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const std::string where = fmt::format("UDP {}:{}", dotted(ip), port);
    if (file_ < 0)
        throw Error(what, where, "a socket", system_error());
    const sockaddr_in address = address_of({ip, port});
    const int on = 1;
    if (ip == INADDR_BROADCAST)
        setsockopt(file_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (bind(file_, generic(address), sizeof address) != 0) {
        const std::string why = system_error();
        close(file_);
        throw Error(what, where, "an address of this machine and a free port", why);
    }
}

UdpSocket::~UdpSocket() {
    if (file_ >= 0)
        close(file_);
}

std::uint16_t UdpSocket::port() const {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(file_, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
}

std::optional<std::pair<std::vector<std::uint8_t>, Peer>> UdpSocket::receive() const {
    constexpr std::size_t kMostBytes = 2048;  // GVCP datagrams end at 576
    std::vector<std::uint8_t> bytes(kMostBytes);
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got = recvfrom(file_, bytes.data(), bytes.size(), MSG_DONTWAIT,
                                 reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0)
        return std::nullopt;
    bytes.resize(static_cast<std::size_t>(got));
    return std::pair(std::move(bytes), Peer{ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)});
}

void UdpSocket::send(const Packet& packet, Peer to) const {
    sockaddr_in address = address_of(to);
    // sendmsg does not write through these pointers.
    std::array<iovec, 2> pieces = {
        {{const_cast<std::uint8_t*>(packet.head.data()), packet.head_bytes},
         {const_cast<std::uint8_t*>(packet.data.data()), packet.data.size()}}};
    msghdr message{};
    message.msg_name = &address;
    message.msg_namelen = sizeof address;
    message.msg_iov = pieces.data();
    message.msg_iovlen = packet.data.empty() ? 1 : 2;
    sendmsg(file_, &message, 0);
}

void UdpSocket::send(std::span<const std::uint8_t> datagram, Peer to) const {
    const sockaddr_in address = address_of(to);
    sendto(file_, datagram.data(), datagram.size(), 0, generic(address), sizeof address);
}

void UdpSocket::set_do_not_fragment(bool on) const {
    const int mode = on ? IP_PMTUDISC_DO : IP_PMTUDISC_DONT;
    setsockopt(file_, IPPROTO_IP, IP_MTU_DISCOVER, &mode, sizeof mode);
}

std::optional<UdpSocket> broadcast_socket(std::uint16_t port) {
    try {
        return UdpSocket(INADDR_BROADCAST, port, "cannot hear broadcasts");
    } catch (const Error&) {
        return std::nullopt;  // the camera is still found by its address
    }
}

std::uint32_t parse_ip(const std::string& text) {
    in_addr address{};
    if (inet_pton(AF_INET, text.c_str(), &address) != 1)
        throw Error("cannot open camera", "address", "an IPv4 address, as in 127.0.0.1", text);
    return ntohl(address.s_addr);
}

}  // namespace nearfield::gige
