// SPDX-License-Identifier: Apache-2.0
/// A stage of two axes behind a GRBL controller.
///
/// Source: Grbl 1.1 (interface, commands, settings, alarm codes) as its documentation says.
#pragma once

#include "acquire/camera.h"
#include "acquire/serial_line.h"

#include <glm/glm.hpp>

#include <string>

namespace nearfield::acquire {

/// What "?" answers.
struct GcodeStatus {
    std::string state;          // "Idle", "Run", "Alarm" ...
    glm::dvec2 position_mm{0};  // machine coordinates
};

/// Reads "<Idle|MPos:1.000,2.000,0.000|FS:0,0>". Throws Error where it says something else.
GcodeStatus gcode_status_from(const std::string& line, const std::string& where);

class GcodeStage {
  public:
    /// Resets the controller and waits for its greeting, reads its travel, homes. Throws Error
    /// where none greets or homing fails, DeviceLost, Stopped.
    GcodeStage(const std::string& path, const ShouldStop& should_stop);

    /// Moves and waits until it stands. Returns the position that is read back, mm.
    /// Throws Error where the target is beyond the travel, the controller refuses or alarms (limit
    /// switch), or it stands elsewhere by more than the tolerance; DeviceLost, Stopped (feed hold).
    glm::dvec2 move_to(glm::dvec2 position_mm,
                       double feed_mm_per_min,
                       double tolerance_mm,
                       const ShouldStop& should_stop);

    GcodeStatus status();
    /// "Grbl 1.1h".
    const std::string& version() const { return version_; }

  private:
    void reset(const ShouldStop& should_stop);
    void read_travel();
    void home(const ShouldStop& should_stop);
    void wait_for_ok(const std::string& command, double patience_s, const ShouldStop& should_stop);
    void wait_until_idle(double patience_s, const ShouldStop& should_stop);
    void require_within_travel(glm::dvec2 position_mm) const;
    [[noreturn]] void silent(const std::string& expected) const;

    SerialLine line_;
    std::string version_;
    glm::dvec2 travel_mm_{0};  // of each axis; 0: not known
};

}  // namespace nearfield::acquire
