// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/u3v_function.h"

#include "sample_data/devices/little_endian.h"
#include "sample_data/devices/u3v_stream.h"
#include "sample_data/gige/pixel_format.h"

#include <algorithm>
#include <utility>

namespace nearfield::devices {
namespace {

namespace address = gige::address;

constexpr std::uint32_t kOwnStart = 0xA000;
constexpr std::uint64_t kCommandKey = 0x43563355;
constexpr std::uint64_t kReadCommand = 0x0800, kWriteCommand = 0x0802;
constexpr std::uint16_t kInvalidAddress = 0x8003, kWriteProtect = 0x8004, kNotImplemented = 0x8001;

gige::Feature text_feature(const char* name, std::uint32_t at) {
    gige::Feature feature;
    feature.name = name;
    feature.category = "DeviceControl";
    feature.tooltip = name;
    feature.kind = gige::Kind::Text;
    feature.address = at;
    feature.access = gige::Access::Read;
    feature.text_bytes = kU3vTextBytes;
    return feature;
}

bool is_moved_by_instruments(const gige::Feature& feature) {
    return feature.address == address::kFilterX || feature.address == address::kFilterY ||
           feature.address == address::kLampOn || feature.address == address::kPhotometer;
}

// The network camera's own ones; the standard registers are elsewhere here.
std::vector<gige::Feature> u3v_features(const gige::Lab& lab) {
    std::vector<gige::Feature> list{text_feature("DeviceVendorName", u3v_address::kManufacturer),
                                    text_feature("DeviceModelName", u3v_address::kModel),
                                    text_feature("DeviceVersion", u3v_address::kVersion),
                                    text_feature("DeviceSerialNumber", u3v_address::kSerial)};
    for (const gige::Feature& feature : gige::features(lab))
        if (feature.address >= kOwnStart && !is_moved_by_instruments(feature))
            list.push_back(feature);
    return list;
}

std::vector<std::uint8_t> xml_of(const gige::Lab& lab) {
    const std::string xml = gige::genicam_xml(u3v_features(lab));
    return {xml.begin(), xml.end()};
}

}  // namespace

U3vFunction::U3vFunction(LabState& lab, std::string serial)
    : lab_(lab),
      serial_(std::move(serial)),
      xml_(xml_of(lab.lab())),
      bootstrap_(serial_, {xml_.size(), u3v_leader({}, 0, 0).size(), u3v_trailer({}, 0, 0).size()}),
      device_({}, lab.lab(), [&lab] { return lab.time_s(); }) {}

std::vector<std::uint8_t> U3vFunction::descriptors() const {
    return u3v_descriptors();
}

std::vector<std::string> U3vFunction::texts() const {
    return {gige::kVendor, gige::kModel, serial_, "CAFE" + serial_};
}

// Halts are cleared, nothing else is asked for.
std::optional<std::vector<std::uint8_t>> U3vFunction::control(
    std::span<const std::uint8_t> /*setup*/) {
    return std::nullopt;
}

std::uint16_t U3vFunction::read(std::uint64_t at, std::span<std::uint8_t> to) {
    const auto copy_from = [&](std::span<const std::uint8_t> bytes, std::uint64_t start) {
        const std::uint64_t begin = at - start;
        for (std::size_t k = 0; k < to.size(); ++k)
            to[k] = begin + k < bytes.size() ? bytes[begin + k] : std::uint8_t{0};
        return std::uint16_t{0};
    };
    if (at >= u3v_address::kXml && at < u3v_address::kXml + xml_.size())
        return copy_from(xml_, u3v_address::kXml);
    if (U3vBootstrap::holds(at, to.size())) {
        bootstrap_.set_payload_size(device_.value(address::kPayloadSize));
        return copy_from(bootstrap_.bytes(), 0);
    }
    if (at < kOwnStart || at >= address::kOwnEnd)
        return kInvalidAddress;
    return static_cast<std::uint16_t>(device_.read(static_cast<std::uint32_t>(at), to));
}

void U3vFunction::tell_lab(std::uint32_t at) {
    const gige::Stage stage = device_.settings().stage;
    if (at == address::kSubject)
        lab_.set_subject(stage.subject);
    if (at == address::kTargetView)
        lab_.set_target_view(stage.target_view);
    if (at == address::kShot)
        lab_.set_shot(stage.shot);
    if (at == address::kAcquisitionStart || at == address::kAcquisitionStop) {
        stream_.clear();
        given_ = 0;
        ready_.reset();
    }
}

std::uint16_t U3vFunction::write(std::uint64_t at, std::span<const std::uint8_t> from) {
    if (bootstrap_.write(at, from))
        return 0;
    if (at < kOwnStart || at >= address::kOwnEnd)
        return kWriteProtect;
    const auto status =
        static_cast<std::uint16_t>(device_.write(static_cast<std::uint32_t>(at), from));
    if (status == 0)
        tell_lab(static_cast<std::uint32_t>(at));
    return status;
}

// A command: key, flags, code, length, id; then address, and count or bytes.
bool U3vFunction::take(std::uint8_t /*endpoint*/, std::span<const std::uint8_t> bytes) {
    constexpr std::size_t kHeaderBytes = 12;
    if (bytes.size() < kHeaderBytes + 8 || number_at(bytes, 0, 4) != kCommandKey)
        return false;
    if (faults.is_silent)
        return true;
    const std::uint64_t code = number_at(bytes, 6, 2), at = number_at(bytes, kHeaderBytes, 8);
    std::vector<std::uint8_t> data;
    std::uint16_t status = kNotImplemented;
    if (code == kReadCommand && bytes.size() >= kHeaderBytes + 12) {
        data.resize(std::min<std::uint64_t>(number_at(bytes, 22, 2), kU3vMostCommandBytes));
        status = read(at, data);
    } else if (code == kWriteCommand) {
        const auto content = bytes.subspan(kHeaderBytes + 8);
        status = write(at, content);
        append(data, 0, 2);
        append(data, content.size(), 2);
    }
    std::vector<std::uint8_t> reply;
    append(reply, kCommandKey, 4);
    append(reply, status, 2);
    append(reply, code + 1, 2);
    append(reply, data.size(), 2);
    append(reply, number_at(bytes, 10, 2), 2);
    reply.insert(reply.end(), data.begin(), data.end());
    acknowledgments_.push_back(std::move(reply));
    return true;
}

// True while a frame is under way; begins one where it is triggered or due.
bool U3vFunction::begin_frame() {
    if (ready_)
        return true;
    gige::Acquisition& acquisition = device_.acquisition;
    if (!acquisition.active || acquisition.frames_left == 0 || !bootstrap_.is_streaming() ||
        faults.is_frameless)
        return false;
    const gige::Settings settings = device_.settings();
    const Clock::time_point now = Clock::now();
    const auto from_s = [](double s) {
        return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
    };
    if (settings.is_triggered ? acquisition.triggers == 0
                              : now < last_begin_ + from_s(1 / settings.frame_rate_hz))
        return false;
    if (settings.is_triggered)
        --acquisition.triggers;
    --acquisition.frames_left;
    last_begin_ = now;
    ready_ = now + from_s(lab_.is_fast() ? 0 : settings.exposure_us * 1e-6);
    return true;
}

void U3vFunction::queue_frame() {
    const gige::Settings settings = device_.settings();
    const gige::Lab& lab = lab_.lab();
    const gige::FormatInfo info = *gige::format_info(static_cast<std::uint32_t>(settings.format));
    std::vector<std::uint8_t> payload =
        gige::pack(settings.format, gige::crop(lab_.expose(settings.exposure_us, settings.gain_db),
                                               lab.sensor_px, settings.offset_px, settings.size_px,
                                               lab.sensor_bits, info.value_bits));
    ++block_id_;
    const bool is_short = faults.short_frames > 0;
    if (is_short) {
        --faults.short_frames;
        payload.resize(payload.size() / 2);
    }
    const std::uint64_t payload_bytes = payload.size();
    stream_.push_back(
        u3v_leader(settings, block_id_, static_cast<std::uint64_t>(lab_.time_s() * 1e9)));
    stream_.push_back(std::move(payload));
    stream_.push_back(u3v_trailer(settings, block_id_, payload_bytes));
    ready_.reset();
}

std::optional<UsbFunction::Reply> U3vFunction::give(std::uint8_t endpoint, std::size_t most_bytes) {
    if (endpoint == kU3vControlIn) {
        if (acknowledgments_.empty())
            return std::nullopt;
        Reply reply{false, std::move(acknowledgments_.front())};
        acknowledgments_.pop_front();
        reply.bytes.resize(std::min(reply.bytes.size(), most_bytes));
        return reply;
    }
    if (stream_.empty() && begin_frame() && Clock::now() >= *ready_)
        queue_frame();
    if (stream_.empty())
        return std::nullopt;
    const std::vector<std::uint8_t>& part = stream_.front();
    const auto begin = part.begin() + static_cast<std::ptrdiff_t>(given_);
    const std::size_t count = std::min(part.size() - given_, most_bytes);
    Reply reply{false, {begin, begin + static_cast<std::ptrdiff_t>(count)}};
    given_ += count;
    if (given_ == part.size()) {
        stream_.pop_front();
        given_ = 0;
    }
    return reply;
}

}  // namespace nearfield::devices
