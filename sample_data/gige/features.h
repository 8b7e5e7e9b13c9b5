// SPDX-License-Identifier: Apache-2.0
/// The camera's features: one table, from which the register map, its checks and the GenICam XML
/// are made.
#pragma once

#include "sample_data/gige/camera.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::gige {

/// Addresses of registers. Below 0xA000 as the standard says, from there on ours.
namespace address {
inline constexpr std::uint32_t kVersion = 0x0000, kDeviceMode = 0x0004, kMacHigh = 0x0008,
                               kMacLow = 0x000C, kInterfaceCapability = 0x0010,
                               kInterfaceConfiguration = 0x0014, kCurrentIp = 0x0024,
                               kSubnetMask = 0x0034, kVendorName = 0x0048, kModelName = 0x0068,
                               kDeviceVersion = 0x0088, kManufacturerInfo = 0x00A8,
                               kSerialNumber = 0x00D8, kUserDefinedName = 0x00E8,
                               kDiscoveryEnd = 0x00F8, kFirstUrl = 0x0200, kSecondUrl = 0x0400,
                               kInterfaceCount = 0x0600, kMessageChannelCount = 0x0900,
                               kStreamChannelCount = 0x0904, kGvcpCapability = 0x0934,
                               kHeartbeatTimeout = 0x0938, kTickFrequencyHigh = 0x093C,
                               kTickFrequencyLow = 0x0940, kTimestampControl = 0x0944,
                               kTimestampHigh = 0x0948, kTimestampLow = 0x094C,
                               kControlPrivilege = 0x0A00, kStreamPort = 0x0D00,
                               kPacketSize = 0x0D04, kPacketDelay = 0x0D08,
                               kStreamDestination = 0x0D18, kStreamSourcePort = 0x0D1C;
inline constexpr std::uint32_t kWidth = 0xA000, kHeight = 0xA004, kOffsetX = 0xA008,
                               kOffsetY = 0xA00C, kPixelFormat = 0xA010, kPayloadSize = 0xA014,
                               kSensorWidth = 0xA018, kSensorHeight = 0xA01C, kWidthMax = 0xA020,
                               kHeightMax = 0xA024, kAcquisitionMode = 0xA028,
                               kAcquisitionFrameCount = 0xA02C, kAcquisitionStart = 0xA030,
                               kAcquisitionStop = 0xA034, kTriggerSelector = 0xA038,
                               kTriggerMode = 0xA03C, kTriggerSource = 0xA040,
                               kTriggerSoftware = 0xA044, kParamsLocked = 0xA048,
                               kExposureTime = 0xA100, kGain = 0xA108, kBlackLevel = 0xA110,
                               kFrameRate = 0xA118, kTemperature = 0xA120, kSubject = 0xA200,
                               kFilterX = 0xA204, kFilterY = 0xA208, kTargetView = 0xA20C,
                               kLampOn = 0xA210, kShot = 0xA214, kLabTime = 0xA218,
                               kPhotometer = 0xA220, kOwnEnd = 0xA300, kXml = 0x10000;
}  // namespace address

/// Largest packet, IP and UDP headers included: what one IPv4 datagram holds, rounded down to 4
/// bytes.
inline constexpr std::uint32_t kLargestPacket = 9000;
inline constexpr std::uint32_t kSmallestPacket = 220;

enum class AcquisitionMode : std::uint32_t { Continuous = 0, SingleFrame = 1, MultiFrame = 2 };

enum class Kind { Integer, Float, Enumeration, Boolean, Command, Text };
enum class Access { Read, ReadWrite, Write };

struct Feature {
    std::string name, category, tooltip;
    Kind kind = Kind::Integer;
    std::uint32_t address = 0;
    Access access = Access::ReadWrite;
    double least = 0, most = 0, step = 1;  // numbers; whole for integers
    std::string most_from = {};            // the feature that has the maximum, in place of `most`
    std::string unit = {};
    std::vector<std::pair<std::string, std::uint32_t>> entries = {};  // enumerations
    bool locked = false;               // refused while frames are acquired
    double initial = 0;                // in ours; standard registers are set by the device
    std::uint32_t text_bytes = 0;      // texts
    int first_bit = 0, last_bit = 31;  // within the register, 0 is the highest

    /// Bytes of its register: text_bytes, 8 for a Float (IEEE 754, big-endian), else 4.
    std::uint32_t bytes() const;
    /// Shares its register with other features.
    bool is_masked() const { return first_bit != 0 || last_bit != 31; }
};

std::vector<Feature> features(const Lab& lab);

/// The GenICam description of a device with these features.
std::string genicam_xml(const std::vector<Feature>& features);

inline constexpr const char* kVendor = "nearfield";
inline constexpr const char* kModel = "VirtualBench";

}  // namespace nearfield::gige
