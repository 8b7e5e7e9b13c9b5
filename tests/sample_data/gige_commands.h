// SPDX-License-Identifier: Apache-2.0
/// A client's side of the control protocol, written from the standard apart from the camera's.
#pragma once

#include "sample_data/gige/gvcp.h"
#include "tests/sample_data/gige_lab.h"

#include <string>

namespace nearfield::gige {

using Bytes = std::vector<std::uint8_t>;

inline void append(Bytes& bytes, std::uint32_t value, int count) {
    for (int k = count - 1; k >= 0; --k)
        bytes.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

inline std::uint32_t number(const Bytes& bytes, std::size_t at, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < count; ++k)
        value = value * 256 + bytes.at(at + k);
    return value;
}

/// A command with data of 32-bit numbers.
inline Bytes command(std::uint32_t code,
                     const std::vector<std::uint32_t>& numbers = {},
                     bool answer_wanted = true,
                     std::uint32_t id = 0x1234) {
    Bytes bytes = {0x42, static_cast<std::uint8_t>(answer_wanted ? 1 : 0)};
    append(bytes, code, 2);
    append(bytes, static_cast<std::uint32_t>(4 * numbers.size()), 2);
    append(bytes, id, 2);
    for (const std::uint32_t value : numbers)
        append(bytes, value, 4);
    return bytes;
}

inline constexpr std::uint32_t kReadReg = 0x80, kWriteReg = 0x82, kReadMem = 0x84, kWriteMem = 0x86;

/// Takes control and starts frames, as many a second as the camera can up to 1000, to a port of
/// this machine.
inline std::vector<Bytes> starting_commands(std::uint16_t port) {
    return {command(kWriteReg, {0x0A00, 2}), command(kWriteReg, {0x0D18, 0x7F000001, 0x0D00, port}),
            command(kWriteMem, {address::kFrameRate, 0x408F4000, 0}),  // 1000.0
            command(kWriteReg, {address::kAcquisitionStart, 1})};
}

/// A camera without sockets, and clients that talk to it.
struct Bench {
    CameraOptions options;
    Device device{options, test_lab({64, 48}), [] { return 12.5; }};
    Control control;
    Clock::time_point now{};
    Peer master{0x7F000001, 5000}, other{0x7F000001, 5001};

    Answer ask(const Bytes& datagram, Peer from) {
        return answer(device, control, datagram, from, now);
    }
    /// The answer's status; 0xFFFF where there is none.
    std::uint32_t status(const Bytes& datagram, Peer from) {
        const Answer reply = ask(datagram, from);
        return reply.datagram.empty() ? 0xFFFF : number(reply.datagram, 0, 2);
    }
    std::uint32_t write(std::uint32_t at, std::uint32_t value, Peer from) {
        return status(command(kWriteReg, {at, value}), from);
    }
    std::uint32_t write(std::uint32_t at, std::uint32_t value) { return write(at, value, master); }
    std::uint32_t write(std::uint32_t at, double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        return status(command(kWriteMem, {at, static_cast<std::uint32_t>(bits >> 32U),
                                          static_cast<std::uint32_t>(bits)}),
                      master);
    }
    std::uint32_t read(std::uint32_t at) {
        return number(ask(command(kReadReg, {at}), master).datagram, 8, 4);
    }
    void take_control() { write(0x0A00, 2U); }
};

}  // namespace nearfield::gige
