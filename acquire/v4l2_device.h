// SPDX-License-Identifier: Apache-2.0
/// A V4L2 node: its formats, controls and buffers, errors as ours.
///
/// Source: Linux media user-space API, part I (video for Linux), single-planar capture by memory
/// mapping.
#pragma once

#include "acquire/camera.h"

#include <linux/videodev2.h>

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace nearfield::acquire {

/// A control's number and range.
struct V4l2Control {
    std::uint32_t id = 0;
    std::int64_t least = 0, most = 0;
    bool is_read_only = false;
};

/// A filled buffer. Its bytes are the driver's until it is given back.
struct V4l2Buffer {
    std::uint32_t index = 0;
    std::span<const unsigned char> bytes;
    std::uint32_t sequence = 0;
    double time_s = 0;       // of the clock that now_s() has; 0: the driver has another
    bool is_start = false;   // of the exposure's start, else of the frame's end
    bool is_broken = false;  // the driver says that data were lost
};

class V4l2Device {
  public:
    /// Throws Error where the node is no camera that streams, DeviceLost where it is not there,
    /// DeviceBusy (as set, set_format and start do) where another program has it.
    explicit V4l2Device(std::string path);
    ~V4l2Device();
    V4l2Device(const V4l2Device&) = delete;
    V4l2Device& operator=(const V4l2Device&) = delete;

    const std::string& path() const { return path_; }
    std::string driver() const, card() const, bus() const;

    /// Controls by name as v4l2-ctl lists them: lower case, `_` between words.
    const std::map<std::string, V4l2Control>& controls() const { return controls_; }
    bool has(const std::string& control) const { return controls_.count(control) > 0; }
    /// Sets and reads back. Throws Error where there is no such control, the value is out of its
    /// range, or another one is read back.
    void set(const std::string& control, int value);
    int value(const std::string& control) const;

    /// The largest frame of a format. Throws Error that lists what there is.
    glm::ivec2 largest(std::uint32_t fourcc) const;
    /// Negotiates; throws Error where the driver takes another format or size.
    v4l2_pix_format set_format(std::uint32_t fourcc, glm::ivec2 size_px);

    /// Maps so many buffers (or as many as the driver gives) and starts. None is queued yet.
    void start(unsigned buffers);
    /// Never fails: a device that is gone has stopped.
    void stop();
    unsigned buffers() const { return static_cast<unsigned>(mapped_.size()); }
    void queue(unsigned index);
    /// A filled buffer, or nothing within the time. That poll says ready and nothing is there is
    /// usual. Throws DeviceLost where it is gone.
    std::optional<V4l2Buffer> dequeue(double patience_s);

  private:
    int call(unsigned long request, void* argument) const;
    void require(unsigned long request, void* argument, const std::string& what) const;
    [[noreturn]] void fail(const std::string& what) const;  // as errno says
    void list_controls();
    std::vector<std::string> format_names() const;

    std::string path_;
    int file_ = -1;
    v4l2_capability capability_{};
    std::map<std::string, V4l2Control> controls_;
    std::vector<std::span<unsigned char>> mapped_;
    bool is_streaming_ = false;
};

/// "Exposure Time, Absolute": "exposure_time_absolute".
std::string v4l2_control_name(const std::string& label);

}  // namespace nearfield::acquire
