// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/device.h"

#include "sample_data/gige/bytes.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace nearfield::gige {
namespace {

constexpr std::uint32_t kStandardEnd = 0x1000, kOwnStart = 0xA000;
constexpr std::uint32_t kTickHz = 1'000'000'000;
constexpr std::uint32_t kTestPacketBit = 0x80000000, kDoNotFragmentBit = 0x40000000;
constexpr std::uint32_t kUserNameBit = 0x80000000, kSerialBit = 0x40000000, kResendBit = 4,
                        kWriteMemoryBit = 2, kConcatenationBit = 1;
constexpr std::uint32_t kDefaultPacketBytes = kLargestPacket;

std::uint64_t frames_of(const Settings& settings) {
    switch (settings.mode) {
        case AcquisitionMode::SingleFrame:
            return 1;
        case AcquisitionMode::MultiFrame:
            return settings.frame_count;
        case AcquisitionMode::Continuous:
            break;
    }
    return std::numeric_limits<std::uint64_t>::max();
}

bool is_number_in(double value, double least, double most, double step) {
    return value >= least && value <= most && std::fmod(value - least, step) == 0;
}

}  // namespace

Device::Device(const CameraOptions& options, const Lab& lab, std::function<double()> time_s)
    : lab_(lab), time_s_(std::move(time_s)), features_(features(lab)) {
    std::string xml = genicam_xml(features_);
    xml.resize((xml.size() + 3) / 4 * 4, '\n');  // memory is read by fours
    memory_.resize(address::kXml + xml.size());
    std::copy(xml.begin(), xml.end(), memory_.begin() + address::kXml);
    fill_standard(options);
    set_text(address::kFirstUrl, 512,
             fmt::format("Local:nearfield.xml;{:X};{:X}", address::kXml, xml.size()));
    fill_own();
}

void Device::fill_standard(const CameraOptions& options) {
    in_addr ip{};
    inet_pton(AF_INET, options.address.c_str(), &ip);
    const std::uint32_t host_ip = ntohl(ip.s_addr);
    set(address::kVersion, 0x00010002);
    set(address::kDeviceMode, 0x80000001);  // big-endian transmitter, UTF-8
    set(address::kMacHigh, 0x0200);         // a locally administered address
    set(address::kMacLow, host_ip);
    set(address::kInterfaceCapability, 4);  // link-local address alone
    set(address::kInterfaceConfiguration, 4);
    set(address::kCurrentIp, host_ip);
    set(address::kSubnetMask, host_ip >> 24U == 127 ? 0xFF000000 : 0xFFFFFF00);
    set_text(address::kVendorName, 32, kVendor);
    set_text(address::kModelName, 32, kModel);
    set_text(address::kDeviceVersion, 32, "1");
    set_text(address::kManufacturerInfo, 48, "simulated camera");
    set_text(address::kSerialNumber, 16, options.serial);
    set(address::kInterfaceCount, 1);
    set(address::kStreamChannelCount, 1);
    set(address::kGvcpCapability, kUserNameBit | kSerialBit | kWriteMemoryBit | kConcatenationBit |
                                      (options.faults.no_resend ? 0 : kResendBit));
    set(address::kHeartbeatTimeout, 3000);
    set(address::kTickFrequencyLow, kTickHz);
    set(address::kPacketSize, kDefaultPacketBytes);
}

void Device::fill_own() {
    for (const Feature& feature : features_) {
        if (feature.address < kOwnStart)
            continue;
        if (feature.kind == Kind::Float)
            set_real(feature.address, feature.initial);
        else
            set(feature.address, static_cast<std::uint32_t>(feature.initial));
    }
    apply(address::kWidth);
}

std::uint32_t Device::value(std::uint32_t at) const {
    return u32_at(memory_, at);
}

void Device::set(std::uint32_t at, std::uint32_t value) {
    put_u32(&memory_[at], value);
}

void Device::set_real(std::uint32_t at, double value) {
    put_u64(&memory_[at], std::bit_cast<std::uint64_t>(value));
}

void Device::set_text(std::uint32_t at, std::uint32_t bytes, const std::string& text) {
    std::fill_n(memory_.begin() + at, bytes, std::uint8_t{0});
    std::copy_n(text.begin(), std::min<std::size_t>(text.size(), bytes - 1), memory_.begin() + at);
}

bool Device::is_readable(std::uint32_t at) const {
    return at < kStandardEnd || (at >= kOwnStart && at < address::kOwnEnd) ||
           (at >= address::kXml && at < memory_.size());
}

const Feature* Device::find(std::uint32_t at) const {
    const auto found = std::find_if(
        features_.begin(), features_.end(),
        [at](const Feature& feature) { return feature.address == at && !feature.is_masked(); });
    return found == features_.end() ? nullptr : &*found;
}

void Device::refresh(std::uint32_t at, std::uint32_t bytes) {
    const auto covers = [at, bytes](std::uint32_t one) { return at < one + 8 && one < at + bytes; };
    if (covers(address::kLabTime))
        set_real(address::kLabTime, time_s_());
    if (covers(address::kPhotometer) && lab_.photometer_lx)
        set_real(address::kPhotometer, lab_.photometer_lx(settings().stage, time_s_()));
    if (covers(address::kTemperature) && lab_.sensor_c)
        set_real(address::kTemperature, lab_.sensor_c(time_s_()));
}

Status Device::read(std::uint32_t at, std::span<std::uint8_t> to) {
    if (at % 4 != 0 || to.size() % 4 != 0)
        return Status::BadAlignment;
    for (std::size_t k = 0; k < to.size(); k += 4)
        if (k > memory_.size() || !is_readable(at + static_cast<std::uint32_t>(k)))
            return Status::InvalidAddress;
    refresh(at, static_cast<std::uint32_t>(to.size()));
    std::copy_n(memory_.begin() + at, to.size(), to.begin());
    return Status::Success;
}

double Device::most_of(const Feature& feature) const {
    if (feature.address == address::kOffsetX)
        return value(address::kSensorWidth) - value(address::kWidth);
    if (feature.address == address::kOffsetY)
        return value(address::kSensorHeight) - value(address::kHeight);
    for (const Feature& other : features_)
        if (other.name == feature.most_from)
            return value(other.address);
    return feature.most;
}

Status Device::check_feature(const Feature& feature, std::span<const std::uint8_t> bytes) const {
    if (feature.access == Access::Read)
        return Status::WriteProtect;
    if (bytes.size() < feature.bytes())
        return Status::InvalidParameter;
    if (feature.locked && (acquisition.active || value(address::kParamsLocked) == 1))
        return Status::AccessDenied;
    if (feature.address == address::kTriggerSoftware &&
        !(acquisition.active && value(address::kTriggerMode) == 1))
        return Status::AccessDenied;
    bool good = true;
    if (feature.kind == Kind::Float) {
        const double asked = f64_at(bytes, 0);
        good = asked >= feature.least && asked <= feature.most;  // false for NaN
    } else if (feature.kind == Kind::Enumeration) {
        good = std::any_of(feature.entries.begin(), feature.entries.end(),
                           [&](const auto& entry) { return entry.second == u32_at(bytes, 0); });
    } else if (feature.kind != Kind::Text) {
        good = is_number_in(u32_at(bytes, 0), feature.least, most_of(feature), feature.step);
    }
    return good ? Status::Success : Status::InvalidParameter;
}

Status Device::check_standard(std::uint32_t at, std::uint32_t asked) const {
    switch (at) {
        case address::kTimestampControl:
        case address::kStreamPort:
        case address::kStreamDestination:
            return Status::Success;
        case address::kPacketSize: {
            const std::uint32_t bytes = asked & 0xFFFFU;
            if (bytes != (value(at) & 0xFFFFU) && acquisition.active)
                return Status::AccessDenied;
            return is_number_in(bytes, kSmallestPacket, kLargestPacket, 4)
                       ? Status::Success
                       : Status::InvalidParameter;
        }
        default:
            return at < kStandardEnd ? Status::WriteProtect : Status::InvalidAddress;
    }
}

Status Device::check(std::uint32_t at, std::span<const std::uint8_t> from) const {
    if (!is_readable(at))
        return Status::InvalidAddress;
    const Feature* feature = find(at);
    if (feature != nullptr)
        return check_feature(*feature, from);
    return at >= kOwnStart ? Status::WriteProtect : check_standard(at, u32_at(from, 0));
}

Status Device::write(std::uint32_t at, std::span<const std::uint8_t> from) {
    if (at % 4 != 0 || from.size() % 4 != 0)
        return Status::BadAlignment;
    const auto size_at = [this](std::uint32_t one) {
        const Feature* feature = find(one);
        return feature == nullptr ? 4 : feature->bytes();
    };
    for (std::uint32_t k = 0; k < from.size(); k += size_at(at + k)) {
        const Status status = check(at + k, from.subspan(k));
        if (status != Status::Success)
            return status;
    }
    for (std::uint32_t k = 0; k < from.size(); k += size_at(at + k)) {
        std::copy_n(from.begin() + k, size_at(at + k), memory_.begin() + at + k);
        apply(at + k);
    }
    return Status::Success;
}

void Device::apply(std::uint32_t at) {
    switch (at) {
        case address::kAcquisitionStart:
            set(at, 0);
            if (!acquisition.active)
                acquisition = {true, acquisition.starts + 1, frames_of(settings()), 0};
            break;
        case address::kAcquisitionStop:
            set(at, 0);
            stop();
            break;
        case address::kTriggerSoftware:
            set(at, 0);
            ++acquisition.triggers;
            break;
        case address::kShot:
            ++shots_;
            break;
        case address::kTriggerMode:
            acquisition.triggers = 0;
            break;
        case address::kTimestampControl: {
            set(at, 0);
            const auto ticks = static_cast<std::uint64_t>(time_s_() * kTickHz);
            put_u64(&memory_[address::kTimestampHigh], ticks);
            break;
        }
        case address::kPacketSize:
            test_packet_asked = test_packet_asked || (value(at) & kTestPacketBit) != 0;
            set(at, value(at) & (kDoNotFragmentBit | 0xFFFFU));
            break;
        default:
            break;
    }
    const Settings now = settings();
    set(address::kWidthMax, value(address::kSensorWidth) - value(address::kOffsetX));
    set(address::kHeightMax, value(address::kSensorHeight) - value(address::kOffsetY));
    set(address::kPayloadSize, static_cast<std::uint32_t>(payload_bytes(now.format, now.size_px)));
}

void Device::stop() {
    acquisition.active = false;
    acquisition.triggers = 0;
}

Settings Device::settings() const {
    const auto pair = [this](std::uint32_t x, std::uint32_t y) {
        return glm::ivec2(static_cast<int>(value(x)), static_cast<int>(value(y)));
    };
    Settings now;
    now.offset_px = pair(address::kOffsetX, address::kOffsetY);
    now.size_px = pair(address::kWidth, address::kHeight);
    now.format = static_cast<PixelFormat>(value(address::kPixelFormat));
    now.mode = static_cast<AcquisitionMode>(value(address::kAcquisitionMode));
    now.frame_count = value(address::kAcquisitionFrameCount);
    now.is_triggered = value(address::kTriggerMode) == 1;
    now.exposure_us = f64_at(memory_, address::kExposureTime);
    now.gain_db = f64_at(memory_, address::kGain);
    now.frame_rate_hz = f64_at(memory_, address::kFrameRate);
    now.packet_bytes = value(address::kPacketSize) & 0xFFFFU;
    now.packet_delay_ns = value(address::kPacketDelay);
    now.do_not_fragment = (value(address::kPacketSize) & kDoNotFragmentBit) != 0;
    now.destination_ip = value(address::kStreamDestination);
    now.destination_port = static_cast<std::uint16_t>(value(address::kStreamPort));
    now.stage.filter = pair(address::kFilterX, address::kFilterY);
    now.stage.subject = static_cast<Subject>(value(address::kSubject));
    now.stage.target_view = static_cast<int>(value(address::kTargetView));
    now.stage.lamp_on = value(address::kLampOn) == 1;
    now.stage.shot = value(address::kShot);
    now.shots = shots_;
    return now;
}

}  // namespace nearfield::gige
