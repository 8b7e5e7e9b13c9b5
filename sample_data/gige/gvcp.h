// SPDX-License-Identifier: Apache-2.0
/// The control protocol: a datagram in, a datagram out. No sockets.
#pragma once

#include "sample_data/gige/device.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace nearfield::gige {

/// Who sent a datagram, in host byte order.
struct Peer {
    std::uint32_t ip = 0;
    std::uint16_t port = 0;

    bool operator==(const Peer&) const = default;
};

using Clock = std::chrono::steady_clock;

/// Who may write. Free again when its holder gives it up or has been silent for the heartbeat
/// timeout.
struct Control {
    std::optional<Peer> holder;
    bool is_exclusive = false;  // nobody else may read either
    Clock::time_point heard;
};

/// A client asks for packets again.
struct ResendRequest {
    std::uint16_t block_id = 0;
    std::uint32_t first_packet = 0, last_packet = 0;
};

struct Answer {
    std::vector<std::uint8_t> datagram;  // empty: no answer
    std::optional<ResendRequest> resend;
    bool is_malformed = false;
    bool is_refused = false;
};

/// Answers a datagram from `from` that came at `now`. Never throws because of its content: what is
/// no GVCP command is dropped, what is wrong in it is answered by a status if an answer is wanted.
Answer answer(Device& device,
              Control& control,
              std::span<const std::uint8_t> datagram,
              Peer from,
              Clock::time_point now);

/// Frees control where its holder has been silent too long, and stops the acquisition then.
void expire_control(Device& device, Control& control, Clock::time_point now);

}  // namespace nearfield::gige
