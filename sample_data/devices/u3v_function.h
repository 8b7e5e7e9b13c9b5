// SPDX-License-Identifier: Apache-2.0
/// A USB3 Vision camera before the bench: the features of the network camera by another wire.
///
/// Source: USB3 Vision 1.1 and GenCP 1.1 (bootstrap registers, control and stream protocol), as the
/// free client library Aravis understands them. Features as docs/gige.md has them, but without
/// packets, and of the lab's only what a person does: LabSubject, LabTargetView, LabShot.
#pragma once

#include "sample_data/devices/lab_state.h"
#include "sample_data/devices/u3v_bootstrap.h"
#include "sample_data/devices/usb_device.h"
#include "sample_data/gige/device.h"

#include <atomic>
#include <chrono>
#include <deque>
#include <string>

namespace nearfield::devices {

struct U3vFaults {
    std::atomic<int> short_frames{0};       // so many next frames lack their second half
    std::atomic<bool> is_silent{false};     // commands are not answered
    std::atomic<bool> is_frameless{false};  // triggers bring nothing
};

class U3vFunction : public UsbFunction {
  public:
    U3vFunction(LabState& lab, std::string serial);

    std::vector<std::uint8_t> descriptors() const override;
    std::vector<std::string> texts() const override;
    std::optional<std::vector<std::uint8_t>> control(std::span<const std::uint8_t> setup) override;
    bool take(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) override;
    std::optional<Reply> give(std::uint8_t endpoint, std::size_t most_bytes) override;

    U3vFaults faults;

  private:
    using Clock = std::chrono::steady_clock;

    /// 0 or a status code of GenCP.
    std::uint16_t read(std::uint64_t at, std::span<std::uint8_t> to);
    std::uint16_t write(std::uint64_t at, std::span<const std::uint8_t> from);
    void tell_lab(std::uint32_t at);
    bool begin_frame();
    void queue_frame();

    LabState& lab_;
    std::string serial_;
    std::vector<std::uint8_t> xml_;
    U3vBootstrap bootstrap_;
    gige::Device device_;
    std::deque<std::vector<std::uint8_t>> acknowledgments_;
    std::deque<std::vector<std::uint8_t>> stream_;  // leader, payload, trailer
    std::size_t given_ = 0;                         // bytes of the stream's first part
    std::optional<Clock::time_point> ready_;        // when the frame under way is exposed
    Clock::time_point last_begin_;
    std::uint64_t block_id_ = 0;
};

}  // namespace nearfield::devices
