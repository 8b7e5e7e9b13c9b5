// SPDX-License-Identifier: Apache-2.0
#include "sample_data/gige/features.h"

#include <algorithm>
#include <utility>

namespace nearfield::gige {
namespace {

using List = std::vector<Feature>;

Feature text(const char* name, std::uint32_t at, std::uint32_t bytes, Access access) {
    Feature feature{.name = name, .category = "DeviceControl", .tooltip = {}};
    feature.kind = Kind::Text;
    feature.address = at;
    feature.text_bytes = bytes;
    feature.access = access;
    return feature;
}

Feature integer(const char* category,
                const char* name,
                std::uint32_t at,
                double least,
                double most,
                double initial,
                const char* tooltip) {
    Feature feature{.name = name, .category = category, .tooltip = tooltip};
    feature.address = at;
    feature.least = least;
    feature.most = most;
    feature.initial = initial;
    return feature;
}

Feature real(const char* category,
             const char* name,
             std::uint32_t at,
             double least,
             double most,
             double initial,
             const char* unit,
             const char* tooltip) {
    Feature feature = integer(category, name, at, least, most, initial, tooltip);
    feature.kind = Kind::Float;
    feature.unit = std::string(unit);
    return feature;
}

Feature choice(const char* category,
               const char* name,
               std::uint32_t at,
               std::vector<std::pair<std::string, std::uint32_t>> entries,
               const char* tooltip) {
    Feature feature = integer(category, name, at, 0, 0, entries.front().second, tooltip);
    feature.kind = Kind::Enumeration;
    feature.entries = std::move(entries);
    return feature;
}

Feature command(const char* category, const char* name, std::uint32_t at, const char* tooltip) {
    Feature feature = integer(category, name, at, 1, 1, 0, tooltip);
    feature.kind = Kind::Command;
    feature.access = Access::Write;
    return feature;
}

Feature read_only(Feature feature) {
    feature.access = Access::Read;
    return feature;
}

Feature locked(Feature feature) {
    feature.locked = true;
    return feature;
}

Feature stepped(Feature feature, double step, std::string most_from = {}) {
    feature.step = step;
    feature.most_from = std::move(most_from);
    return feature;
}

Feature bits(Feature feature, int first, int last) {
    feature.first_bit = first;
    feature.last_bit = last;
    return feature;
}

void add_device(List& list) {
    list.push_back(text("DeviceVendorName", address::kVendorName, 32, Access::Read));
    list.push_back(text("DeviceModelName", address::kModelName, 32, Access::Read));
    list.push_back(text("DeviceVersion", address::kDeviceVersion, 32, Access::Read));
    list.push_back(text("DeviceSerialNumber", address::kSerialNumber, 16, Access::Read));
    list.push_back(text("DeviceUserID", address::kUserDefinedName, 16, Access::ReadWrite));
    list.push_back(read_only(real("DeviceControl", "DeviceTemperature", address::kTemperature, -100,
                                  200, 0, "C", "Of the sensor")));
}

void add_image(List& list, const Lab& lab) {
    const char* category = "ImageFormatControl";
    const double width = lab.sensor_px.x, height = lab.sensor_px.y;
    const auto size = [&](const char* name, std::uint32_t at, double value, const char* tooltip) {
        return read_only(integer(category, name, at, 1, value, value, tooltip));
    };
    list.push_back(size("SensorWidth", address::kSensorWidth, width, "Columns of the sensor"));
    list.push_back(size("SensorHeight", address::kSensorHeight, height, "Rows of the sensor"));
    list.push_back(size("WidthMax", address::kWidthMax, width, "What OffsetX leaves"));
    list.push_back(size("HeightMax", address::kHeightMax, height, "What OffsetY leaves"));
    // Steps of 2 keep a Bayer pattern's phase and pairs of packed pixels.
    list.push_back(locked(stepped(
        integer(category, "Width", address::kWidth, 2, width, width, "Columns of the region"), 2,
        "WidthMax")));
    list.push_back(locked(stepped(
        integer(category, "Height", address::kHeight, 2, height, height, "Rows of the region"), 2,
        "HeightMax")));
    list.push_back(locked(stepped(integer(category, "OffsetX", address::kOffsetX, 0, width - 2, 0,
                                          "The region's first column"),
                                  2)));
    list.push_back(locked(stepped(
        integer(category, "OffsetY", address::kOffsetY, 0, height - 2, 0, "The region's first row"),
        2)));
    std::vector<std::pair<std::string, std::uint32_t>> formats;
    for (const FormatInfo& format : kFormats)
        if (format.is_bayer == lab.is_bayer)
            formats.emplace_back(format.name, static_cast<std::uint32_t>(format.format));
    list.push_back(locked(
        choice(category, "PixelFormat", address::kPixelFormat, formats, "How pixels are sent")));
}

void add_acquisition(List& list, const Lab& lab) {
    const char* category = "AcquisitionControl";
    list.push_back(locked(choice(category, "AcquisitionMode", address::kAcquisitionMode,
                                 {{"Continuous", 0}, {"SingleFrame", 1}, {"MultiFrame", 2}},
                                 "How many frames a start gives")));
    list.push_back(
        locked(integer(category, "AcquisitionFrameCount", address::kAcquisitionFrameCount, 1, 65535,
                       1, "Frames of a start in mode MultiFrame")));
    list.push_back(
        command(category, "AcquisitionStart", address::kAcquisitionStart, "Frames from now on"));
    list.push_back(
        command(category, "AcquisitionStop", address::kAcquisitionStop,
                "Drops the frame that is being exposed, ends the one that is being sent"));
    list.push_back(real(category, "AcquisitionFrameRate", address::kFrameRate, 0.01, 10000, 10,
                        "Hz", "Most frames a second without a trigger"));
    list.push_back(choice(category, "TriggerSelector", address::kTriggerSelector,
                          {{"FrameStart", 0}}, "What a trigger starts"));
    list.push_back(choice(category, "TriggerMode", address::kTriggerMode, {{"Off", 0}, {"On", 1}},
                          "Whether a frame waits for its trigger"));
    list.push_back(choice(category, "TriggerSource", address::kTriggerSource, {{"Software", 0}},
                          "Where triggers come from"));
    list.push_back(command(category, "TriggerSoftware", address::kTriggerSoftware,
                           "One frame; triggers that come too early wait"));
    list.push_back(real(category, "ExposureTime", address::kExposureTime, 10, 1e7, 10000, "us",
                        "Of the next frame"));
    list.push_back(real("AnalogControl", "Gain", address::kGain, 0, 24, 0, "dB",
                        "Of the next frame, 20 dB are a factor of 10"));
    list.push_back(
        read_only(real("AnalogControl", "BlackLevel", address::kBlackLevel, 0, 65535,
                       lab.black_level_dn, "DN", "Value without light, in the sensor's bits")));
}

void add_transport(List& list) {
    const char* category = "TransportLayerControl";
    list.push_back(read_only(integer(category, "PayloadSize", address::kPayloadSize, 0, 4294967295.,
                                     0, "Bytes of a frame")));
    list.push_back(integer(category, "TLParamsLocked", address::kParamsLocked, 0, 1, 0,
                           "1: what changes the frame's layout is refused"));
    list.push_back(locked(
        bits(stepped(integer(category, "GevSCPSPacketSize", address::kPacketSize, kSmallestPacket,
                             kLargestPacket, 0, "Bytes of a packet, IP and UDP headers included"),
                     4),
             16, 31)));
    list.push_back(bits(command(category, "GevSCPSFireTestPacket", address::kPacketSize,
                                "Sends a packet of that size"),
                        0, 0));
    list.push_back(integer(category, "GevSCPD", address::kPacketDelay, 0, 1e9, 0,
                           "Delay between packets in ticks, which are ns"));
    list.push_back(integer(category, "GevHeartbeatTimeout", address::kHeartbeatTimeout, 500, 600000,
                           0, "Silence in ms after which control is free again"));
}

void add_lab(List& list, const Lab& lab) {
    const char* category = "LabControl";
    std::vector<std::pair<std::string, std::uint32_t>> subjects;
    const auto offer = [&](const char* name, Subject subject) {
        subjects.emplace_back(name, static_cast<std::uint32_t>(subject));
    };
    offer("Position", Subject::Position);
    if (lab.can_open)
        offer("Open", Subject::Open);
    offer("Flat", Subject::Flat);
    if (lab.target_views > 0)
        offer("Target", Subject::Target);
    offer("Cap", Subject::Cap);
    if (lab.can_see_filter) {
        offer("Filter", Subject::Filter);
        offer("Blocked", Subject::Blocked);
    }
    list.push_back(
        choice(category, "LabSubject", address::kSubject, subjects, "What the camera is shown"));
    list.push_back(integer(category, "LabFilterX", address::kFilterX, 0, lab.filter_grid.x - 1, 0,
                           "Column of the filter's position"));
    list.push_back(integer(category, "LabFilterY", address::kFilterY, 0, lab.filter_grid.y - 1, 0,
                           "Row of the filter's position"));
    list.push_back(integer(category, "LabTargetView", address::kTargetView, 0,
                           std::max(0, lab.target_views - 1), 0, "Pose of the calibration target"));
    Feature lamp = integer(category, "LabLampOn", address::kLampOn, 0, 1, 1, "The lamp has power");
    lamp.kind = Kind::Boolean;
    list.push_back(lamp);
    list.push_back(integer(category, "LabShot", address::kShot, 0, 4294967295., 0,
                           "The client's number of a shot: noise depends on it and on the frames "
                           "since it was set"));
    list.push_back(read_only(real(category, "LabTime", address::kLabTime, 0, 1e12, 0, "s",
                                  "Since the camera's start, never backwards")));
    list.push_back(read_only(real(category, "LabPhotometer", address::kPhotometer, 0, 1e12, 0, "lx",
                                  "The photometer's reading now")));
}

}  // namespace

std::uint32_t Feature::bytes() const {
    return kind == Kind::Text ? text_bytes : kind == Kind::Float ? 8 : 4;
}

std::vector<Feature> features(const Lab& lab) {
    List list;
    add_device(list);
    add_image(list, lab);
    add_acquisition(list, lab);
    add_transport(list);
    add_lab(list, lab);
    return list;
}

}  // namespace nearfield::gige
