// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/u3v_function.h"

#include "sample_data/devices/little_endian.h"
#include "sample_data/gige/pixel_format.h"

#include <algorithm>
#include <utility>

namespace nearfield::devices {
namespace {

namespace address = gige::address;

// GenCP's registers, USB3 Vision's, the stream's, the table that tells where the XML is.
constexpr std::uint32_t kManufacturer = 0x0004, kModel = 0x0044, kVersion = 0x00C4,
                        kSerial = 0x0144, kUserName = 0x0184, kResponseTime = 0x01CC,
                        kManifestAddress = 0x01D0, kSbrmAddress = 0x01D8, kSbrm = 0x8000,
                        kSirm = 0x8100, kManifest = 0x8200, kBootstrapEnd = 0x8300, kXml = 0x100000;
constexpr std::uint32_t kTextBytes = 64, kMostCommandBytes = 1024;
constexpr std::uint32_t kOwnStart = 0xA000;
constexpr std::uint8_t kControlIn = 0x81, kStreamIn = 0x82;
constexpr std::uint64_t kCommandKey = 0x43563355, kLeaderKey = 0x4C563355, kTrailerKey = 0x54563355;
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
    feature.text_bytes = kTextBytes;
    return feature;
}

bool is_moved_by_instruments(const gige::Feature& feature) {
    return feature.address == address::kFilterX || feature.address == address::kFilterY ||
           feature.address == address::kLampOn || feature.address == address::kPhotometer;
}

// The network camera's own ones; the standard registers are elsewhere here.
std::vector<gige::Feature> u3v_features(const gige::Lab& lab) {
    std::vector<gige::Feature> list{
        text_feature("DeviceVendorName", kManufacturer), text_feature("DeviceModelName", kModel),
        text_feature("DeviceVersion", kVersion), text_feature("DeviceSerialNumber", kSerial)};
    for (const gige::Feature& feature : gige::features(lab))
        if (feature.address >= kOwnStart && !is_moved_by_instruments(feature))
            list.push_back(feature);
    return list;
}

}  // namespace

U3vFunction::U3vFunction(LabState& lab, std::string serial)
    : lab_(lab),
      serial_(std::move(serial)),
      bootstrap_(kBootstrapEnd),
      device_({}, lab.lab(), [&lab] { return lab.time_s(); }) {
    const std::string xml = gige::genicam_xml(u3v_features(lab.lab()));
    xml_.assign(xml.begin(), xml.end());
    fill_bootstrap();
}

void U3vFunction::put(std::uint32_t at, std::uint64_t value, std::size_t bytes) {
    for (std::size_t k = 0; k < bytes; ++k)
        bootstrap_[at + k] = static_cast<std::uint8_t>(value >> (8 * k));
}

void U3vFunction::put_text(std::uint32_t at, const std::string& text) {
    std::copy_n(text.begin(), std::min<std::size_t>(text.size(), kTextBytes - 1),
                bootstrap_.begin() + at);
}

void U3vFunction::fill_bootstrap() {
    put(0, 0x00010001, 4);  // GenCP 1.1
    put_text(kManufacturer, gige::kVendor);
    put_text(kModel, gige::kModel);
    put_text(kVersion, "1");
    put_text(kSerial, serial_);
    put_text(kUserName, "");
    put(kResponseTime, 200, 4);  // ms
    put(kManifestAddress, kManifest, 8);
    put(kSbrmAddress, kSbrm, 8);
    put(kSbrm, 0x00010001, 4);
    put(kSbrm + 0x14, kMostCommandBytes, 4);
    put(kSbrm + 0x18, kMostCommandBytes, 4);
    put(kSbrm + 0x1C, 1, 4);  // stream channels
    put(kSbrm + 0x20, kSirm, 8);
    put(kSirm + 0x10, leader({}).size(), 4);
    put(kSirm + 0x14, trailer({}, 0).size(), 4);
    put(kManifest, 1, 8);  // one file, not compressed
    put(kManifest + 8, 0x01000000, 4);
    put(kManifest + 16, kXml, 8);
    put(kManifest + 24, xml_.size(), 8);
}

std::vector<std::uint8_t> U3vFunction::descriptors() const {
    constexpr std::uint8_t kMiscellaneous = 0xEF, kUsb3Vision = 0x05, kBulk = 2, kInterface = 0x24;
    std::vector<std::uint8_t> bytes{
        18, 1, 0x00, 0x03, kMiscellaneous, 2, 1, 9, 0xFE, 0xCA, 0x03, 0x01, 0, 1, 1, 2, 3, 1};
    std::vector<std::uint8_t> rest{9,
                                   2,
                                   0,
                                   0,
                                   2,
                                   1,
                                   0,
                                   0x80,
                                   50,  // configuration
                                   8,
                                   11,
                                   0,
                                   2,
                                   kMiscellaneous,
                                   kUsb3Vision,
                                   0,
                                   0,  // two interfaces are one camera
                                   9,
                                   4,
                                   0,
                                   0,
                                   2,
                                   kMiscellaneous,
                                   kUsb3Vision,
                                   0,
                                   0,  // control
                                   20,
                                   kInterface,
                                   1,
                                   0,
                                   0,
                                   1,
                                   0,
                                   0,
                                   0,
                                   1,
                                   0,
                                   4,
                                   1,
                                   2,
                                   0,
                                   3,
                                   0,
                                   0,
                                   0,
                                   0,
                                   7,
                                   5,
                                   kControlIn,
                                   kBulk,
                                   0,
                                   4,
                                   0,
                                   7,
                                   5,
                                   0x01,
                                   kBulk,
                                   0,
                                   4,
                                   0,
                                   9,
                                   4,
                                   1,
                                   0,
                                   1,
                                   kMiscellaneous,
                                   kUsb3Vision,
                                   2,
                                   0,  // stream
                                   7,
                                   5,
                                   kStreamIn,
                                   kBulk,
                                   0,
                                   4,
                                   0};
    rest[2] = static_cast<std::uint8_t>(rest.size());
    bytes.insert(bytes.end(), rest.begin(), rest.end());
    return bytes;
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
    const auto copy_from = [&](const std::vector<std::uint8_t>& bytes, std::uint64_t start) {
        const std::uint64_t begin = at - start;
        for (std::size_t k = 0; k < to.size(); ++k)
            to[k] = begin + k < bytes.size() ? bytes[begin + k] : std::uint8_t{0};
        return std::uint16_t{0};
    };
    if (at >= kXml && at < kXml + xml_.size())
        return copy_from(xml_, kXml);
    if (at + to.size() <= kBootstrapEnd) {
        put(kSirm + 8, device_.value(address::kPayloadSize), 8);
        return copy_from(bootstrap_, 0);
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
    if (at >= kSirm && at + from.size() <= kManifest) {
        std::copy(from.begin(), from.end(), bootstrap_.begin() + static_cast<std::ptrdiff_t>(at));
        return 0;
    }
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
        data.resize(std::min<std::uint64_t>(number_at(bytes, 22, 2), kMostCommandBytes));
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

std::vector<std::uint8_t> U3vFunction::leader(const gige::Settings& settings) const {
    constexpr std::uint64_t kBytes = 52, kImage = 1;
    std::vector<std::uint8_t> bytes;
    append(bytes, kLeaderKey, 4);
    append(bytes, 0, 2);
    append(bytes, kBytes, 2);
    append(bytes, block_id_, 8);
    append(bytes, 0, 2);
    append(bytes, kImage, 2);
    append(bytes, static_cast<std::uint64_t>(lab_.time_s() * 1e9), 8);
    append(bytes, static_cast<std::uint32_t>(settings.format), 4);
    for (const int number :
         {settings.size_px.x, settings.size_px.y, settings.offset_px.x, settings.offset_px.y})
        append(bytes, static_cast<std::uint32_t>(number), 4);
    append(bytes, 0, 4);  // padding
    return bytes;
}

std::vector<std::uint8_t> U3vFunction::trailer(const gige::Settings& settings,
                                               std::size_t payload_bytes) const {
    constexpr std::uint64_t kBytes = 32;
    std::vector<std::uint8_t> bytes;
    append(bytes, kTrailerKey, 4);
    append(bytes, 0, 2);
    append(bytes, kBytes, 2);
    append(bytes, block_id_, 8);
    append(bytes, 0, 4);
    append(bytes, payload_bytes, 8);
    append(bytes, static_cast<std::uint32_t>(settings.size_px.y), 4);
    return bytes;
}

// True while a frame is under way; begins one where it is triggered or due.
bool U3vFunction::begin_frame() {
    if (ready_)
        return true;
    gige::Acquisition& acquisition = device_.acquisition;
    const bool is_streaming = (bootstrap_[kSirm + 4] & 1U) != 0;
    if (!acquisition.active || acquisition.frames_left == 0 || !is_streaming)
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
    stream_.push_back(leader(settings));
    stream_.push_back(std::move(payload));
    stream_.push_back(trailer(settings, stream_.back().size()));
    ready_.reset();
}

std::optional<UsbFunction::Reply> U3vFunction::give(std::uint8_t endpoint, std::size_t most_bytes) {
    if (endpoint == kControlIn) {
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
