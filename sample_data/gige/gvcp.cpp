// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/gvcp.h"

#include "sample_data/gige/bytes.h"

#include <algorithm>

namespace nearfield::gige {
namespace {

constexpr std::uint8_t kKey = 0x42, kAnswerWanted = 0x01;
constexpr std::size_t kHeaderBytes = 8, kMostMemoryBytes = 536;
constexpr std::size_t kMostRegisters = 67;  // of a WRITEREG: pairs in kMostMemoryBytes

enum Code : std::uint16_t {
    kDiscovery = 0x0002,
    kForceIp = 0x0004,
    kPacketResend = 0x0040,
    kReadRegister = 0x0080,
    kWriteRegister = 0x0082,
    kReadMemory = 0x0084,
    kWriteMemory = 0x0086,
};

struct Command {
    bool answer_wanted = false;
    std::uint16_t code = 0, id = 0;
    std::span<const std::uint8_t> data;
};

// What an answer's header says, and what follows it.
struct Reply {
    Status status = Status::Success;
    std::vector<std::uint8_t> data;
};

std::vector<std::uint8_t> acknowledge(const Command& command, const Reply& reply) {
    std::vector<std::uint8_t> bytes(kHeaderBytes + reply.data.size());
    put_u16(bytes.data(), static_cast<std::uint16_t>(reply.status));
    put_u16(&bytes[2], command.code + 1U);
    put_u16(&bytes[4], static_cast<std::uint32_t>(reply.data.size()));
    put_u16(&bytes[6], command.id);
    std::copy(reply.data.begin(), reply.data.end(), bytes.begin() + kHeaderBytes);
    return bytes;
}

bool may_read(const Control& control, Peer from) {
    return !control.is_exclusive || control.holder == from;
}

bool may_write(const Control& control, Peer from) {
    return !control.holder || control.holder == from;
}

Status write_privilege(Device& device, Control& control, std::uint32_t asked, Peer from) {
    constexpr std::uint32_t kExclusive = 1, kControl = 2;
    if ((asked & ~(kExclusive | kControl)) != 0)
        return Status::InvalidParameter;
    device.set(address::kControlPrivilege, asked);
    control.is_exclusive = (asked & kExclusive) != 0;
    if (asked != 0) {
        control.holder = from;
    } else {
        control.holder.reset();
        device.stop();
    }
    return Status::Success;
}

Status write(Device& device,
             Control& control,
             std::uint32_t at,
             std::span<const std::uint8_t> from_bytes,
             Peer from) {
    if (!may_write(control, from))
        return Status::AccessDenied;
    if (at == address::kControlPrivilege && from_bytes.size() == 4)
        return write_privilege(device, control, u32_at(from_bytes, 0), from);
    // Whoever has no control may not change what its holder relies on, nor may anybody by surprise.
    return control.holder ? device.write(at, from_bytes) : Status::AccessDenied;
}

Reply read_registers(Device& device, std::span<const std::uint8_t> data) {
    if (data.empty() || data.size() % 4 != 0 || data.size() > kMostMemoryBytes)
        return {Status::InvalidHeader, {}};
    Reply reply;
    for (std::size_t k = 0; k < data.size(); k += 4) {
        reply.data.resize(k + 4);
        reply.status = device.read(u32_at(data, k), std::span(reply.data).last(4));
        if (reply.status != Status::Success) {
            reply.data.resize(k);  // as many as were read
            break;
        }
    }
    return reply;
}

Reply write_registers(Device& device,
                      Control& control,
                      std::span<const std::uint8_t> data,
                      Peer from) {
    if (data.empty() || data.size() % 8 != 0 || data.size() > 8 * kMostRegisters)
        return {Status::InvalidHeader, {}};
    Reply reply;
    std::uint32_t written = 0;
    while (written < data.size() / 8 && reply.status == Status::Success) {
        reply.status = write(device, control, u32_at(data, 8UL * written),
                             data.subspan(8UL * written + 4, 4), from);
        written += reply.status == Status::Success ? 1 : 0;
    }
    reply.data.resize(4);
    put_u16(&reply.data[2], written);
    return reply;
}

Reply read_memory(Device& device, std::span<const std::uint8_t> data) {
    if (data.size() != 8)
        return {Status::InvalidHeader, {}};
    const std::size_t count = u16_at(data, 6);
    if (count == 0 || count > kMostMemoryBytes)
        return {Status::InvalidParameter, {}};
    Reply reply;
    reply.data.resize(4 + count);
    put_u32(reply.data.data(), u32_at(data, 0));
    reply.status = device.read(u32_at(data, 0), std::span(reply.data).subspan(4));
    if (reply.status != Status::Success)
        reply.data.clear();
    return reply;
}

Reply write_memory(Device& device,
                   Control& control,
                   std::span<const std::uint8_t> data,
                   Peer from) {
    if (data.size() < 8 || data.size() > 4 + kMostMemoryBytes)
        return {Status::InvalidHeader, {}};
    Reply reply;
    reply.status = write(device, control, u32_at(data, 0), data.subspan(4), from);
    reply.data.resize(4);
    if (reply.status == Status::Success)
        put_u16(&reply.data[2], static_cast<std::uint32_t>(data.size() - 4));
    return reply;
}

Reply reply_to(Device& device, Control& control, const Command& command, Peer from) {
    if (command.code == kDiscovery) {
        Reply reply;
        reply.data.resize(address::kDiscoveryEnd);
        reply.status = device.read(0, reply.data);
        return reply;
    }
    if (!may_read(control, from))
        return {Status::AccessDenied, {}};
    switch (command.code) {
        case kReadRegister:
            return read_registers(device, command.data);
        case kWriteRegister:
            return write_registers(device, control, command.data, from);
        case kReadMemory:
            return read_memory(device, command.data);
        case kWriteMemory:
            return write_memory(device, control, command.data, from);
        default:
            return {Status::NotImplemented, {}};
    }
}

std::optional<ResendRequest> resend_request(const Control& control,
                                            std::span<const std::uint8_t> data,
                                            Peer from) {
    // Clients ask from the port that they receive frames at, which is not the master's.
    if (data.size() < 12 || !control.holder || control.holder->ip != from.ip)
        return std::nullopt;
    constexpr std::uint32_t kPacketMask = 0xFFFFFF;
    return ResendRequest{static_cast<std::uint16_t>(u16_at(data, 2)), u32_at(data, 4) & kPacketMask,
                         u32_at(data, 8) & kPacketMask};
}

// An address forced on a device is meant for one MAC address; ours cannot be changed.
bool is_for_another(const Device& device, const Command& command) {
    return command.code == kForceIp &&
           (command.data.size() < 8 ||
            u16_at(command.data, 2) != (device.value(address::kMacHigh) & 0xFFFFU) ||
            u32_at(command.data, 4) != device.value(address::kMacLow));
}

}  // namespace

Answer answer(Device& device,
              Control& control,
              std::span<const std::uint8_t> datagram,
              Peer from,
              Clock::time_point now) {
    Answer result;
    if (datagram.size() < kHeaderBytes || datagram[0] != kKey) {
        result.is_malformed = true;
        return result;
    }
    Command command{
        (datagram[1] & kAnswerWanted) != 0, static_cast<std::uint16_t>(u16_at(datagram, 2)),
        static_cast<std::uint16_t>(u16_at(datagram, 6)), datagram.subspan(kHeaderBytes)};
    result.is_malformed = u16_at(datagram, 4) != command.data.size();
    if (control.holder == from)
        control.heard = now;
    if (is_for_another(device, command))
        return result;
    if (command.code == kPacketResend) {
        if (!result.is_malformed)
            result.resend = resend_request(control, command.data, from);
        return result;
    }
    const bool was_free = !control.holder;
    const Reply reply = result.is_malformed ? Reply{Status::InvalidHeader, {}}
                                            : reply_to(device, control, command, from);
    if (was_free && control.holder)
        control.heard = now;
    result.is_refused = reply.status != Status::Success;
    if (command.answer_wanted)
        result.datagram = acknowledge(command, reply);
    return result;
}

void expire_control(Device& device, Control& control, Clock::time_point now) {
    const std::chrono::milliseconds patience(device.value(address::kHeartbeatTimeout));
    if (!control.holder || now - control.heard < patience)
        return;
    control = {};
    device.set(address::kControlPrivilege, 0);
    device.stop();
}

}  // namespace nearfield::gige
