// SPDX-License-Identifier: Apache-2.0
#include "acquire/v4l2_camera.h"

#include "acquire/settings.h"
#include "acquire/unpack.h"
#include "acquire/v4l2_device.h"
#include "acquire/v4l2_stage.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace nearfield::acquire {
namespace {

constexpr unsigned kV4l2Buffers = 4;  // drivers fill one while the others wait
constexpr double kV4l2Patience_s =
    20;                               // beyond the exposure; a device that is gone says so at once
constexpr double kV4l2Look_s = 0.05;  // between looks at Ctrl-C
constexpr double kExposureUnit_us = 100;  // of V4L2_CID_EXPOSURE_ABSOLUTE

constexpr const char* kExposure = "exposure_time_absolute";
constexpr const char* kExposureOld = "exposure_absolute";  // kernels before 5.15

struct Named {
    std::uint32_t fourcc;
    const char* name;  // of GenICam's, as in plans and unpack()
};

constexpr std::array<Named, 12> kV4l2Formats = {{
    {V4L2_PIX_FMT_GREY, "Mono8"},
    {V4L2_PIX_FMT_Y10, "Mono10"},
    {V4L2_PIX_FMT_Y12, "Mono12"},
    {V4L2_PIX_FMT_Y16, "Mono16"},
    {V4L2_PIX_FMT_SRGGB8, "BayerRG8"},
    {V4L2_PIX_FMT_SGRBG8, "BayerGR8"},
    {V4L2_PIX_FMT_SGBRG8, "BayerGB8"},
    {V4L2_PIX_FMT_SBGGR8, "BayerBG8"},
    {V4L2_PIX_FMT_SRGGB12, "BayerRG12"},
    {V4L2_PIX_FMT_SGRBG12, "BayerGR12"},
    {V4L2_PIX_FMT_SGBRG12, "BayerGB12"},
    {V4L2_PIX_FMT_SBGGR12, "BayerBG12"},
}};

std::uint32_t fourcc_of(const std::string& name, const std::string& where) {
    std::string known;
    for (const Named& format : kV4l2Formats) {
        if (name == format.name)
            return format.fourcc;
        known += (known.empty() ? "" : ", ") + std::string(format.name);
    }
    throw Error{"pixel format", where, "one of " + known, name};
}

class V4l2Camera : public Camera {
  public:
    explicit V4l2Camera(std::shared_ptr<V4l2Device> device) : device_(std::move(device)) {}

    CameraIdentity identity() const override {
        return {device_->driver(), device_->card(), device_->bus(), device_->path()};
    }
    void configure(const capture::CameraPlan& plan) override;
    double set_exposure(double exposure_us) override;
    double gain_db() override { return 0; }
    Exposed expose(const ShouldStop& should_stop) override;
    std::optional<double> temperature_c() override { return std::nullopt; }

  private:
    void set_size(const capture::CameraPlan& plan);
    bool is_exposed_since(double time_s, const V4l2Buffer& buffer) const;
    V4l2Buffer wait_for_frame(const ShouldStop& should_stop);
    std::vector<unsigned char> rows_of(const V4l2Buffer& buffer) const;

    std::shared_ptr<V4l2Device> device_;
    PixelFormat format_;
    glm::ivec2 size_px_{0};
    std::size_t line_bytes_ = 0;  // in memory, padding included
    bool is_byte_swapped_ = false;
    double exposure_us_ = 0;
    std::vector<unsigned> ours_;  // buffers that the driver does not have
};

void V4l2Camera::set_size(const capture::CameraPlan& plan) {
    if (plan.region_min_px != glm::ivec2(0))
        throw Error{"region", device_->path(), "one that begins at 0, 0: V4L2 offers sizes alone",
                    fmt::format("{}, {}", plan.region_min_px.x, plan.region_min_px.y)};
    const std::uint32_t fourcc = fourcc_of(plan.pixel_format, device_->path());
    size_px_ = plan.region_size_px.x > 0 ? plan.region_size_px : device_->largest(fourcc);
    line_bytes_ = device_->set_format(fourcc, size_px_).bytesperline;
}

void V4l2Camera::configure(const capture::CameraPlan& plan) {
    if (plan.gain_db != 0)
        throw Error{"gain", device_->path(),
                    "gain_db 0: V4L2's gain has no unit; set it by camera.controls, as \"gain\"",
                    fmt::format("{:g}", plan.gain_db)};
    device_->stop();  // the format is locked while buffers exist
    format_ = pixel_format_of(plan.pixel_format);
    is_byte_swapped_ = plan.is_byte_swapped;
    set_size(plan);
    for (const char* automatic : {"auto_exposure", "exposure_auto"})
        if (device_->has(automatic))
            device_->set(automatic, V4L2_EXPOSURE_MANUAL);
    for (const auto& [control, value] : plan.controls)
        device_->set(control, value);
    device_->start(kV4l2Buffers);
    ours_.clear();
    for (unsigned k = 0; k < device_->buffers(); ++k)
        ours_.push_back(k);
}

double V4l2Camera::set_exposure(double exposure_us) {
    const char* control = device_->has(kExposure) ? kExposure : kExposureOld;
    device_->set(control, static_cast<int>(std::lround(exposure_us / kExposureUnit_us)));
    return exposure_us_ = device_->value(control) * kExposureUnit_us;
}

// Without a time stamp that we can compare a frame counts: the latency that a session looks for is
// then all that guards against old ones.
bool V4l2Camera::is_exposed_since(double time_s, const V4l2Buffer& buffer) const {
    if (buffer.time_s == 0)
        return true;
    constexpr double kRounding_s = 1e-6;
    const double start_s = buffer.is_start ? buffer.time_s : buffer.time_s - 1e-6 * exposure_us_;
    return start_s >= time_s - kRounding_s;
}

V4l2Buffer V4l2Camera::wait_for_frame(const ShouldStop& should_stop) {
    const double asked_s = now_s();
    const double patience_s = 2e-6 * exposure_us_ + kV4l2Patience_s;  // one may be under way
    for (const unsigned index : ours_)
        device_->queue(index);
    ours_.clear();
    while (true) {
        if (should_stop())
            throw Stopped{};
        if (const std::optional<V4l2Buffer> buffer = device_->dequeue(kV4l2Look_s)) {
            if (buffer->is_broken || is_exposed_since(asked_s, *buffer)) {
                ours_.push_back(buffer->index);
                return *buffer;
            }
            device_->queue(buffer->index);
        }
        if (now_s() > asked_s + patience_s)
            throw DeviceLost{"the camera sends nothing", device_->path(),
                             fmt::format("a frame within {:.1f} s", patience_s), "none"};
    }
}

// The rows without the padding that drivers put behind them.
std::vector<unsigned char> V4l2Camera::rows_of(const V4l2Buffer& buffer) const {
    const std::size_t row = byte_count(format_, {size_px_.x, 1});
    const auto rows = static_cast<std::size_t>(size_px_.y);
    const std::size_t line = std::max(line_bytes_, row);
    if (buffer.bytes.size() < line * (rows - 1) + row)
        throw IncompleteFrame{"incomplete frame", device_->path(),
                              fmt::format("{} bytes", line * rows),
                              fmt::format("{}", buffer.bytes.size())};
    std::vector<unsigned char> bytes;
    bytes.reserve(row * rows);
    for (std::size_t k = 0; k < rows; ++k) {
        const auto begin = buffer.bytes.begin() + static_cast<std::ptrdiff_t>(k * line);
        bytes.insert(bytes.end(), begin, begin + static_cast<std::ptrdiff_t>(row));
    }
    return bytes;
}

Exposed V4l2Camera::expose(const ShouldStop& should_stop) {
    const V4l2Buffer buffer = wait_for_frame(should_stop);
    if (buffer.is_broken)
        throw IncompleteFrame{"incomplete frame", device_->path(), "all of it",
                              "the driver's error flag"};
    Exposed exposed;
    exposed.frame = unpack(format_, size_px_, rows_of(buffer), is_byte_swapped_);
    exposed.pixel_format = format_.name;
    exposed.camera_time_ns = static_cast<std::uint64_t>(std::llround(buffer.time_s * 1e9));
    exposed.frame_id = buffer.sequence;
    return exposed;
}

}  // namespace

std::vector<FoundCamera> find_v4l2_cameras() {
    constexpr int kMostNodes = 64;
    std::vector<FoundCamera> found;
    for (int k = 0; k < kMostNodes; ++k) {
        const std::string path = fmt::format("/dev/video{}", k);
        if (access(path.c_str(), R_OK | W_OK) != 0)
            continue;
        try {
            const V4l2Device device(path);
            found.push_back({path, "V4L2", device.driver(), device.card(), device.bus(), path});
        } catch (const Error&) {
            continue;  // no camera: metadata and output have nodes of the same names
        }
    }
    return found;
}

Bench open_v4l2(const std::string& path) {
    auto device = std::make_shared<V4l2Device>(path);
    Bench bench;
    bench.stage = v4l2_stage(device);
    bench.camera = std::make_unique<V4l2Camera>(std::move(device));
    return bench;
}

}  // namespace nearfield::acquire
