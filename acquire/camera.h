// SPDX-License-Identifier: Apache-2.0
/// A camera, whatever its wire. One frame for one trigger: what a measurement needs.
#pragma once

#include "formats/capture/frame.h"
#include "formats/capture/plan.h"
#include "formats/files/error.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace nearfield::acquire {

/// The device does not answer any more; opening it again may help. Other Errors of a device are
/// about what was asked of it.
struct DeviceLost : Error {
    using Error::Error;
};

/// Another program has the device; it may be about to end (until_free.h).
struct DeviceBusy : Error {
    using Error::Error;
};

/// A frame did not arrive whole; another trigger may do.
struct IncompleteFrame : Error {
    using Error::Error;
};

/// The user wants to stop (Ctrl-C). Devices look at it ten times a second or more often.
struct Stopped {};
using ShouldStop = std::function<bool()>;

struct CameraIdentity {
    std::string vendor, model, serial, address;
};

/// One frame and what the camera said of it.
struct Exposed {
    capture::Frame frame;
    std::string pixel_format;          // as the camera names it: "Mono12Packed"
    std::uint64_t camera_time_ns = 0;  // the camera's clock
    std::uint64_t frame_id = 0;        // counts up; 0 where the camera has none
};

/// An open camera that we control. Not thread-safe.
class Camera {
  public:
    Camera() = default;
    Camera(const Camera&) = delete;
    Camera& operator=(const Camera&) = delete;
    virtual ~Camera() = default;

    virtual CameraIdentity identity() const = 0;
    /// Sets all but the exposure. Throws Error where the camera takes another value than asked for,
    /// DeviceBusy where another program has it: it may be called again.
    virtual void configure(const capture::CameraPlan& plan) = 0;
    /// Asks for an exposure; returns what the camera says it has, us.
    virtual double set_exposure(double exposure_us) = 0;
    virtual double gain_db() = 0;
    /// Triggers and waits. Throws DeviceLost, IncompleteFrame, Stopped.
    virtual Exposed expose(const ShouldStop& should_stop) = 0;
    virtual std::optional<double> temperature_c() = 0;
};

}  // namespace nearfield::acquire
