// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/u3v_bootstrap.h"

#include "sample_data/devices/fixed_text.h"
#include "sample_data/gige/device.h"

#include <algorithm>
#include <initializer_list>

namespace nearfield::devices {
namespace {

using Bytes = std::vector<std::uint8_t>;
namespace address = u3v_address;

// GenCP's registers, USB3 Vision's, the stream's, the table that tells where the XML is.
constexpr std::uint32_t kUserName = 0x0184, kResponseTime = 0x01CC, kManifestAddress = 0x01D0,
                        kSbrmAddress = 0x01D8, kSbrm = 0x8000, kSirm = 0x8100, kManifest = 0x8200,
                        kBootstrapEnd = 0x8300;
constexpr std::uint8_t kMiscellaneous = 0xEF, kUsb3Vision = 0x05, kBulk = 2, kInterface = 0x24;

Bytes concatenated(std::initializer_list<Bytes> parts) {
    Bytes all;
    for (const Bytes& part : parts)
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

Bytes bulk_endpoint(std::uint8_t address) {
    return {7, 5, address, kBulk, 0, 4, 0};  // packets of 1024 bytes
}

Bytes interface(std::uint8_t number, std::uint8_t endpoints, std::uint8_t protocol) {
    return {9, 4, number, 0, endpoints, kMiscellaneous, kUsb3Vision, protocol, 0};
}

}  // namespace

std::vector<std::uint8_t> u3v_descriptors() {
    constexpr std::uint8_t kControl = 0, kStream = 2, kControlOut = 0x01;
    const Bytes device{18, 1, 0x00, 0x03, kMiscellaneous, 2, 1, 9, 0xFE, 0xCA, 0x03, 0x01, 0, 1,
                       1,  2, 3,    1};
    const Bytes association{8, 11, 0, 2, kMiscellaneous, kUsb3Vision, 0, 0};
    // GenCP 1.0, USB3 Vision 1.0; the camera's names are the device's texts.
    const Bytes camera{20, kInterface, 1, 0, 0, 1, 0, 0, 0, 1, 0, 4, 1, 2, 0, 3, 0, 0, 0, 0};
    Bytes configuration = concatenated({{9, 2, 0, 0, 2, 1, 0, 0x80, 50},
                                        association,
                                        interface(0, 2, kControl),
                                        camera,
                                        bulk_endpoint(kU3vControlIn),
                                        bulk_endpoint(kControlOut),
                                        interface(1, 1, kStream),
                                        bulk_endpoint(kU3vStreamIn)});
    configuration[2] = static_cast<std::uint8_t>(configuration.size());
    return concatenated({device, configuration});
}

U3vBootstrap::U3vBootstrap(const std::string& serial, const Sizes& sizes) : bytes_(kBootstrapEnd) {
    put(0, 0x00010001, 4);  // GenCP 1.1
    put(address::kManufacturer, gige::kVendor);
    put(address::kModel, gige::kModel);
    put(address::kVersion, "1");
    put(address::kSerial, serial);
    put(kUserName, "");
    put(kResponseTime, 200, 4);  // ms
    put(kManifestAddress, kManifest, 8);
    put(kSbrmAddress, kSbrm, 8);
    put(kSbrm, 0x00010001, 4);
    put(kSbrm + 0x14, kU3vMostCommandBytes, 4);
    put(kSbrm + 0x18, kU3vMostCommandBytes, 4);
    put(kSbrm + 0x1C, 1, 4);  // stream channels
    put(kSbrm + 0x20, kSirm, 8);
    put(kSirm + 0x10, sizes.leader, 4);
    put(kSirm + 0x14, sizes.trailer, 4);
    put(kManifest, 1, 8);  // one file, not compressed
    put(kManifest + 8, 0x01000000, 4);
    put(kManifest + 16, address::kXml, 8);
    put(kManifest + 24, sizes.xml, 8);
}

void U3vBootstrap::put(std::uint32_t at, std::uint64_t value, std::size_t bytes) {
    for (std::size_t k = 0; k < bytes; ++k)
        bytes_[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
}

void U3vBootstrap::put(std::uint32_t at, const std::string& text) {
    put_text(&bytes_[at], kU3vTextBytes, text);
}

bool U3vBootstrap::holds(std::uint64_t at, std::size_t bytes) {
    return at <= kBootstrapEnd && bytes <= kBootstrapEnd - at;
}

bool U3vBootstrap::write(std::uint64_t at, std::span<const std::uint8_t> from) {
    if (at < kSirm || !holds(at, from.size()) || at + from.size() > kManifest)
        return false;
    std::copy(from.begin(), from.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
    return true;
}

void U3vBootstrap::set_payload_size(std::uint64_t bytes) {
    put(kSirm + 8, bytes, 8);
}

bool U3vBootstrap::is_streaming() const {
    return (bytes_[kSirm + 4] & 1U) != 0;
}

}  // namespace nearfield::devices
