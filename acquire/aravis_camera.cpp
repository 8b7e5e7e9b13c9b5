// SPDX-License-Identifier: Apache-2.0
#include "acquire/aravis_camera.h"

#include "acquire/aravis_device.h"
#include "acquire/camera_stage.h"
#include "acquire/settings.h"
#include "acquire/unpack.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace nearfield::acquire {
namespace {

constexpr int kBuffers = 6;
// Beyond the exposure, until a frame must have come. Generous: a camera that is gone is told by
// control that is lost, and a machine may be too busy for seconds.
constexpr double kPatience_s = 20;
constexpr guint64 kPop_us = 50'000;       // between looks at Ctrl-C
constexpr double kGainRounding_db = 0.1;  // cameras count gain in steps

class AravisCamera : public Camera {
  public:
    explicit AravisCamera(std::shared_ptr<Device> device) : device_(std::move(device)) {}

    CameraIdentity identity() const override;
    void configure(const capture::CameraPlan& plan) override;
    double set_exposure(double exposure_us) override;
    double gain_db() override;
    Exposed expose(const ShouldStop& should_stop) override;
    std::optional<double> temperature_c() override;

  private:
    void set_region(const capture::CameraPlan& plan);
    void set_gain(double gain_db);
    void set_packet_size(int bytes);
    void start_stream();
    void drop_waiting_frames();
    Handle<ArvBuffer> wait_for_frame(double until_s, const ShouldStop& should_stop);
    Exposed unpack_buffer(ArvBuffer* buffer);

    ArvCamera* camera() const { return device_->camera.get(); }

    std::shared_ptr<Device> device_;
    double exposure_us_ = 0;
    bool is_byte_swapped_ = false;
    bool has_temperature_ = false;
};

CameraIdentity AravisCamera::identity() const {
    const auto text = [this](const char* (*get)(ArvCamera*, GError**)) {
        return text_or_empty(checked(*device_, "read the camera's name",
                                     [&](GError** error) { return get(camera(), error); }));
    };
    return {text(arv_camera_get_vendor_name), text(arv_camera_get_model_name),
            text(arv_camera_get_device_serial_number), device_->name};
}

void AravisCamera::set_region(const capture::CameraPlan& plan) {
    gint width = 0, height = 0;
    checked(*device_, "read the sensor's size", [&](GError** error) {
        return arv_camera_get_sensor_size(camera(), &width, &height, error);
    });
    const glm::ivec2 size =
        plan.region_size_px.x > 0 ? plan.region_size_px : glm::ivec2(width, height);
    const glm::ivec2 end = plan.region_min_px + size;
    if (end.x > width || end.y > height)
        throw Error{"region outside of the sensor", device_->name,
                    fmt::format("within {} x {} px", width, height),
                    fmt::format("up to {}, {}", end.x, end.y)};
    checked(*device_, "set the region", [&](GError** error) {
        return arv_camera_set_region(camera(), plan.region_min_px.x, plan.region_min_px.y, size.x,
                                     size.y, error);
    });
    gint x = 0, y = 0, got_width = 0, got_height = 0;
    checked(*device_, "read the region", [&](GError** error) {
        return arv_camera_get_region(camera(), &x, &y, &got_width, &got_height, error);
    });
    check_taken("region's left, px", plan.region_min_px.x, x, 0);
    check_taken("region's top, px", plan.region_min_px.y, y, 0);
    check_taken("region's width, px", size.x, got_width, 0);
    check_taken("region's height, px", size.y, got_height, 0);
}

void AravisCamera::set_gain(double gain_db) {
    if (arv_camera_is_gain_available(camera(), nullptr) == 0) {
        if (gain_db != 0)
            throw Error{"the camera has no gain", device_->name, "gain_db 0",
                        fmt::format("{:g}", gain_db)};
        return;
    }
    checked(*device_, "set gain",
            [&](GError** error) { return arv_camera_set_gain(camera(), gain_db, error); });
    const double got_db = this->gain_db();
    if (std::abs(got_db - gain_db) > kGainRounding_db)
        check_taken("gain, dB", gain_db, got_db, 0);
}

void AravisCamera::set_packet_size(int bytes) {
    if (arv_camera_is_gv_device(camera()) == 0)
        return;
    if (bytes > 0)
        checked(*device_, "set the packet size", [&](GError** error) {
            arv_camera_gv_set_packet_size_adjustment(camera(), ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
            return arv_camera_gv_set_packet_size(camera(), bytes, error);
        });
    else
        checked(*device_, "find a packet size that arrives",
                [&](GError** error) { return arv_camera_gv_auto_packet_size(camera(), error); });
}

// Aravis' own settings are those of a stream that must keep up: a receive buffer as small as a
// frame, a quarter of its packets asked for again, given up after 0.1 s. Here nothing hurries, and
// the machine may be busy.
void make_patient(ArvStream* stream) {
    constexpr gint kSocketBuffer_bytes = 16 << 20;  // as far as the system allows
    constexpr gdouble kMostAskedAgain = 2;          // of a frame's packets
    constexpr guint kRetention_us = 1'000'000;      // since the frame's last packet
    g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 kSocketBuffer_bytes, "packet-resend", ARV_GV_STREAM_PACKET_RESEND_ALWAYS,
                 "packet-request-ratio", kMostAskedAgain, "frame-retention", kRetention_us,
                 nullptr);
}

void AravisCamera::start_stream() {
    const auto payload = checked(*device_, "read the frame's size", [&](GError** error) {
        return arv_camera_get_payload(camera(), error);
    });
    device_->stream.reset(checked(*device_, "open the stream", [&](GError** error) {
        return arv_camera_create_stream(camera(), nullptr, nullptr, error);
    }));
    ArvStream* stream = device_->stream.get();
    if (ARV_IS_GV_STREAM(stream))
        make_patient(stream);
    for (int k = 0; k < kBuffers; ++k)
        arv_stream_push_buffer(stream, arv_buffer_new(payload, nullptr));
    checked(*device_, "start the camera",
            [&](GError** error) { return arv_camera_start_acquisition(camera(), error); });
}

void AravisCamera::configure(const capture::CameraPlan& plan) {
    is_byte_swapped_ = plan.is_byte_swapped;
    pixel_format_of(plan.pixel_format);  // refuses what could not be unpacked
    checked(*device_, "set the pixel format", [&](GError** error) {
        return arv_camera_set_pixel_format_from_string(camera(), plan.pixel_format.c_str(), error);
    });
    set_region(plan);
    set_gain(plan.gain_db);
    checked(*device_, "set the acquisition mode", [&](GError** error) {
        return arv_camera_set_acquisition_mode(camera(), ARV_ACQUISITION_MODE_CONTINUOUS, error);
    });
    checked(*device_, "set the software trigger",
            [&](GError** error) { return arv_camera_set_trigger(camera(), "Software", error); });
    set_packet_size(plan.packet_size_bytes);
    has_temperature_ = device_->has("DeviceTemperature");
    start_stream();
}

double AravisCamera::set_exposure(double exposure_us) {
    double least_us = 0, most_us = 0;
    checked(*device_, "read the limits of exposure", [&](GError** error) {
        return arv_camera_get_exposure_time_bounds(camera(), &least_us, &most_us, error);
    });
    if (!(exposure_us >= least_us && exposure_us <= most_us))
        throw Error{"exposure out of the camera's range", device_->name,
                    fmt::format("{:g} ... {:g} us", least_us, most_us),
                    fmt::format("{:g} us", exposure_us)};
    checked(*device_, "set the exposure", [&](GError** error) {
        return arv_camera_set_exposure_time(camera(), exposure_us, error);
    });
    exposure_us_ = exposure_us;
    return checked(*device_, "read the exposure",
                   [&](GError** error) { return arv_camera_get_exposure_time(camera(), error); });
}

double AravisCamera::gain_db() {
    if (arv_camera_is_gain_available(camera(), nullptr) == 0)
        return 0;
    return checked(*device_, "read the gain",
                   [&](GError** error) { return arv_camera_get_gain(camera(), error); });
}

std::optional<double> AravisCamera::temperature_c() {
    if (!has_temperature_)
        return std::nullopt;
    return checked(*device_, "read the temperature", [&](GError** error) {
        return arv_device_get_float_feature_value(device_->device(), "DeviceTemperature", error);
    });
}

// Frames that came after their time-out, or before a change: they would be taken for the next one.
void AravisCamera::drop_waiting_frames() {
    while (ArvBuffer* stale = arv_stream_try_pop_buffer(device_->stream.get()))
        arv_stream_push_buffer(device_->stream.get(), stale);
}

Handle<ArvBuffer> AravisCamera::wait_for_frame(double until_s, const ShouldStop& should_stop) {
    while (true) {
        if (should_stop())
            throw Stopped{};
        if (ArvBuffer* buffer = arv_stream_timeout_pop_buffer(device_->stream.get(), kPop_us))
            return Handle<ArvBuffer>(buffer);
        if (device_->is_lost)
            throw DeviceLost{"the camera is gone", device_->name, "a frame", "control was lost"};
        if (now_s() > until_s)
            throw DeviceLost{
                "the camera sends nothing", device_->name,
                fmt::format("a frame within {:.1f} s", kPatience_s + exposure_us_ * 1e-6), "none"};
    }
}

Exposed AravisCamera::unpack_buffer(ArvBuffer* buffer) {
    const std::string name =
        text_or_empty(checked(*device_, "read the pixel format", [&](GError** error) {
            return arv_camera_get_pixel_format_as_string(camera(), error);
        }));
    std::size_t size = 0;
    const auto* bytes = static_cast<const unsigned char*>(arv_buffer_get_image_data(buffer, &size));
    gint x = 0, y = 0, width = 0, height = 0;
    arv_buffer_get_image_region(buffer, &x, &y, &width, &height);
    Exposed exposed;
    exposed.frame = unpack(pixel_format_of(name), {width, height}, {bytes, size}, is_byte_swapped_);
    exposed.pixel_format = name;
    exposed.camera_time_ns = arv_buffer_get_timestamp(buffer);
    exposed.frame_id = arv_buffer_get_frame_id(buffer);
    return exposed;
}

Exposed AravisCamera::expose(const ShouldStop& should_stop) {
    drop_waiting_frames();
    checked(*device_, "trigger",
            [&](GError** error) { return arv_camera_software_trigger(camera(), error); });
    Handle<ArvBuffer> buffer =
        wait_for_frame(now_s() + exposure_us_ * 1e-6 + kPatience_s, should_stop);
    const ArvBufferStatus status = arv_buffer_get_status(buffer.get());
    if (status != ARV_BUFFER_STATUS_SUCCESS) {
        arv_stream_push_buffer(device_->stream.get(), buffer.release());
        throw IncompleteFrame{"incomplete frame", device_->name, "all packets",
                              fmt::format("buffer status {}", static_cast<int>(status))};
    }
    Exposed exposed = unpack_buffer(buffer.get());
    arv_stream_push_buffer(device_->stream.get(), buffer.release());
    return exposed;
}

}  // namespace

std::vector<FoundCamera> find_cameras() {
    arv_update_device_list();
    std::vector<FoundCamera> found;
    for (unsigned k = 0; k < arv_get_n_devices(); ++k)
        found.push_back(
            {text_or_empty(arv_get_device_id(k)), text_or_empty(arv_get_device_protocol(k)),
             text_or_empty(arv_get_device_vendor(k)), text_or_empty(arv_get_device_model(k)),
             text_or_empty(arv_get_device_serial_nbr(k)),
             text_or_empty(arv_get_device_address(k))});
    return found;
}

Bench open_aravis(const std::string& name) {
    std::shared_ptr<Device> device = open_device(name);
    Bench bench;
    bench.stage = camera_stage(device);
    bench.camera = std::make_unique<AravisCamera>(std::move(device));
    return bench;
}

}  // namespace nearfield::acquire
