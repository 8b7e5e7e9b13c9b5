// SPDX-License-Identifier: Apache-2.0
/// What a USB3 Vision camera is before it does anything: its USB descriptors, and the registers of
/// GenCP 1.1 and USB3 Vision 1.1 that tell a host where all else is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace nearfield::devices {

/// Registers that features are bound to.
namespace u3v_address {
constexpr std::uint32_t kManufacturer = 0x0004, kModel = 0x0044, kVersion = 0x00C4,
                        kSerial = 0x0144;
constexpr std::uint32_t kXml = 0x100000;
}  // namespace u3v_address

constexpr std::uint32_t kU3vTextBytes = 64, kU3vMostCommandBytes = 1024;
constexpr std::uint8_t kU3vControlIn = 0x81, kU3vStreamIn = 0x82;

/// Device and configuration descriptor: a control and a stream interface, associated.
std::vector<std::uint8_t> u3v_descriptors();

/// The registers below the features' own.
class U3vBootstrap {
  public:
    struct Sizes {
        std::size_t xml, leader, trailer;  // bytes
    };
    U3vBootstrap(const std::string& serial, const Sizes& sizes);

    /// Whether `bytes` from `at` lie within; what is beyond belongs to somebody else.
    static bool holds(std::uint64_t at, std::size_t bytes);
    std::span<const std::uint8_t> bytes() const { return bytes_; }
    /// The stream's registers alone can be written. False: write-protected.
    bool write(std::uint64_t at, std::span<const std::uint8_t> from);

    void set_payload_size(std::uint64_t bytes);
    bool is_streaming() const;

  private:
    void put(std::uint32_t at, std::uint64_t value, std::size_t bytes);
    void put(std::uint32_t at, const std::string& text);

    std::vector<std::uint8_t> bytes_;
};

}  // namespace nearfield::devices
