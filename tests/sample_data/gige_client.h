// SPDX-License-Identifier: Apache-2.0
/// Aravis, unmodified, as the camera's client.
#pragma once

#include "tests/sample_data/gige_lab.h"

#include <arv.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearfield::gige {

struct Unref {
    void operator()(void* object) const { g_object_unref(object); }
};
template <typename Object>
using Owned = std::unique_ptr<Object, Unref>;

/// Collects what Aravis says of a failure: pass error.out(), then look at text().
class Failure {
  public:
    Failure() = default;
    ~Failure() { g_clear_error(&error_); }
    Failure(const Failure&) = delete;
    Failure& operator=(const Failure&) = delete;

    GError** out() {
        g_clear_error(&error_);
        return &error_;
    }
    std::string text() const { return error_ == nullptr ? "" : error_->message; }

  private:
    GError* error_ = nullptr;
};

/// An address of this process alone, so that tests that run at the same time each have port 3956.
inline std::string own_address() {
    const auto id = static_cast<unsigned>(getpid());
    return "127." + std::to_string(1 + (id >> 16U) % 254) + "." + std::to_string(id >> 8U & 255U) +
           "." + std::to_string(id & 255U);
}

inline CameraOptions quick_options() {
    CameraOptions options;
    options.address = own_address();
    options.serial = "T" + std::to_string(getpid());
    options.fast = true;
    return options;
}

struct Received {
    ArvBufferStatus status = ARV_BUFFER_STATUS_UNKNOWN;
    std::uint64_t block_id = 0, timestamp_ns = 0;
    glm::ivec2 size_px{0}, offset_px{0};
    std::vector<std::uint16_t> values;
};

/// The values in a payload, read bit by bit.
inline std::vector<std::uint16_t> unpack(PixelFormat format,
                                         const std::vector<std::uint8_t>& bytes,
                                         std::size_t count) {
    std::vector<std::uint16_t> values(count);
    const auto byte = [&](std::size_t k) { return static_cast<unsigned>(bytes.at(k)); };
    for (std::size_t k = 0; k < count; ++k) {
        unsigned value = 0;
        if (format == PixelFormat::Mono8 || format == PixelFormat::BayerRG8)
            value = byte(k);
        else if (format == PixelFormat::Mono12Packed)
            value =
                byte(k / 2 * 3 + (k % 2) * 2) << 4U | (byte(k / 2 * 3 + 1) >> (k % 2 * 4) & 0xFU);
        else if (format == PixelFormat::Mono12p)
            value = (byte(12 * k / 8) | byte(12 * k / 8 + 1) << 8U) >> (k % 2 * 4) & 0xFFFU;
        else
            value = byte(2 * k) | byte(2 * k + 1) << 8U;
        values[k] = static_cast<std::uint16_t>(value);
    }
    return values;
}

class Client {
  public:
    explicit Client(const std::string& address)
        : camera(arv_camera_new(address.c_str(), failure.out())) {}

    void set(const char* feature, const char* value) {
        arv_camera_set_string(camera.get(), feature, value, failure.out());
        EXPECT_EQ(failure.text(), "") << feature;
    }
    void set(const char* feature, double value) {
        arv_camera_set_float(camera.get(), feature, value, failure.out());
        EXPECT_EQ(failure.text(), "") << feature;
    }
    void set(const char* feature, int value) {
        arv_camera_set_integer(camera.get(), feature, value, failure.out());
        EXPECT_EQ(failure.text(), "") << feature;
    }
    void run(const char* command) {
        arv_camera_execute_command(camera.get(), command, failure.out());
        EXPECT_EQ(failure.text(), "") << command;
    }

    /// Opens the stream, with buffers for a few frames. The ordinary socket: the other needs
    /// privileges.
    void open_stream() {
        arv_camera_gv_set_stream_options(camera.get(), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
        const guint payload = arv_camera_get_payload(camera.get(), failure.out());
        stream.reset(arv_camera_create_stream(camera.get(), nullptr, nullptr, failure.out()));
        ASSERT_NE(stream, nullptr) << failure.text();
        // A busy machine may let a frame's packets wait; the defaults give up after 100 ms.
        g_object_set(stream.get(), "frame-retention", 3000000, nullptr);
        for (int k = 0; k < 16; ++k)
            arv_stream_push_buffer(stream.get(), arv_buffer_new(payload, nullptr));
    }

    /// The next frame, or nothing when it does not come.
    std::optional<Received> next_frame(unsigned patience_ms = 10000) {
        ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream.get(), patience_ms * 1000UL);
        if (buffer == nullptr)
            return std::nullopt;
        Received frame;
        frame.status = arv_buffer_get_status(buffer);
        frame.block_id = arv_buffer_get_frame_id(buffer);
        frame.timestamp_ns = arv_buffer_get_timestamp(buffer);
        if (frame.status == ARV_BUFFER_STATUS_SUCCESS) {
            arv_buffer_get_image_region(buffer, &frame.offset_px.x, &frame.offset_px.y,
                                        &frame.size_px.x, &frame.size_px.y);
            std::size_t size = 0;
            const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
            frame.values =
                unpack(static_cast<PixelFormat>(arv_buffer_get_image_pixel_format(buffer)),
                       {data, data + size},
                       static_cast<std::size_t>(frame.size_px.x) *
                           static_cast<std::size_t>(frame.size_px.y));
        }
        arv_stream_push_buffer(stream.get(), buffer);
        return frame;
    }

    Failure failure;
    Owned<ArvCamera> camera;
    Owned<ArvStream> stream;
};

/// What a frame of the test lab should hold.
inline std::vector<std::uint16_t> expected_values(const Received& frame,
                                                  PixelFormat format,
                                                  const Exposure& exposure) {
    const int bits = format_info(static_cast<std::uint32_t>(format))->value_bits;
    std::vector<std::uint16_t> values;
    for (int y = 0; y < frame.size_px.y; ++y)
        for (int x = 0; x < frame.size_px.x; ++x) {
            const int value = test_value(x + frame.offset_px.x, y + frame.offset_px.y, exposure);
            values.push_back(static_cast<std::uint16_t>(bits < 12 ? value >> (12 - bits)
                                                                  : value << (bits - 12)));
        }
    return values;
}

}  // namespace nearfield::gige
