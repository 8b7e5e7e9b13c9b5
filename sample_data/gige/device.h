// SPDX-License-Identifier: Apache-2.0
/// The camera's registers and what writing them means. No sockets, no threads, no clock of its own.
#pragma once

#include "sample_data/gige/features.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace nearfield::gige {

/// Status codes of GVCP and GVSP.
enum class Status : std::uint16_t {
    Success = 0x0000,
    NotImplemented = 0x8001,
    InvalidParameter = 0x8002,
    InvalidAddress = 0x8003,
    WriteProtect = 0x8004,
    BadAlignment = 0x8005,
    AccessDenied = 0x8006,
    PacketUnavailable = 0x800C,
    InvalidHeader = 0x800E,
};

/// How a frame is laid out and exposed, as the registers say.
struct Settings {
    glm::ivec2 offset_px{0}, size_px{0};
    PixelFormat format = PixelFormat::Mono8;
    AcquisitionMode mode = AcquisitionMode::Continuous;
    std::uint32_t frame_count = 1;  // of mode MultiFrame
    bool is_triggered = false;
    double exposure_us = 0, gain_db = 0, frame_rate_hz = 0;
    std::uint32_t packet_bytes = 0;  // IP and UDP headers included
    std::uint32_t packet_delay_ns = 0;
    bool do_not_fragment = false;
    std::uint32_t destination_ip = 0;  // host byte order
    std::uint16_t destination_port = 0;
    Stage stage;
    std::uint64_t shots = 0;  // times that Stage::shot was set
};

/// Acquisition, as commands left it and as the exposure thread uses it up.
struct Acquisition {
    bool active = false;
    std::uint64_t starts = 0;       // tells a new acquisition from the one before
    std::uint64_t frames_left = 0;  // meaningful where active
    std::uint64_t triggers = 0;     // waiting, where frames are triggered
};

class Device {
  public:
    /// time_s: the lab's clock, for registers that show it.
    Device(const CameraOptions& options, const Lab& lab, std::function<double()> time_s);

    /// Reads `to.size()` bytes; address and size must be multiples of 4. `to` is left as it was on
    /// errors.
    Status read(std::uint32_t at, std::span<std::uint8_t> to);
    /// Writes all registers that the bytes cover, or none. A register must be covered in full.
    Status write(std::uint32_t at, std::span<const std::uint8_t> from);

    std::uint32_t value(std::uint32_t at) const;
    /// Sets a standard register without checks; for what the camera itself finds out.
    void set(std::uint32_t at, std::uint32_t value);

    Settings settings() const;
    void stop();

    Acquisition acquisition;
    bool test_packet_asked = false;  // set by a write, cleared by whoever sends it

  private:
    void set_real(std::uint32_t at, double value);
    void set_text(std::uint32_t at, std::uint32_t bytes, const std::string& text);
    void fill_standard(const CameraOptions& options);
    void fill_own();
    void refresh(std::uint32_t at, std::uint32_t bytes);
    Status check(std::uint32_t at, std::span<const std::uint8_t> from) const;
    Status check_standard(std::uint32_t at, std::uint32_t value) const;
    Status check_feature(const Feature& feature, std::span<const std::uint8_t> bytes) const;
    double most_of(const Feature& feature) const;
    void apply(std::uint32_t at);
    bool is_readable(std::uint32_t at) const;
    const Feature* find(std::uint32_t at) const;

    Lab lab_;
    std::function<double()> time_s_;
    std::vector<Feature> features_;
    std::vector<std::uint8_t> memory_;  // standard, own, and the XML
    std::uint64_t shots_ = 0;
};

}  // namespace nearfield::gige
