// SPDX-License-Identifier: Apache-2.0
/// What the simulated devices share: the bench as instruments and controls moved it.
#pragma once

#include "sample_data/gige/camera.h"

#include <glm/glm.hpp>

#include <chrono>
#include <cstdint>
#include <mutex>
#include <vector>

namespace nearfield::devices {

/// How the devices meet the bench.
struct Mounting {
    glm::dvec2 first_position_mm{-5, -5};  // of the filter's column 0, row 0, on the stage
    glm::dvec2 pitch_mm{1};
    double lamp_voltage_v = 12.0, lamp_current_a = 4.5;  // nominal: current follows voltage
    double warm_up_rel = 0.0, warm_up_s = 300.0;         // of the current, as the lamp's light
};

/// Thread-safe: every device has its own thread, or umockdev's.
class LabState {
  public:
    /// `fast`: exposures take no time; the lab's time goes on as if.
    LabState(gige::Lab lab, Mounting mounting, bool fast);

    const gige::Lab& lab() const { return lab_; }
    bool is_fast() const { return is_fast_; }
    double time_s() const;

    void set_subject(gige::Subject subject);
    void set_target_view(int view);
    /// Frames are counted from 0 again: their noise depends on both numbers.
    void set_shot(std::uint32_t shot);
    gige::Stage stage() const;

    /// Stands there now; the filter is at the nearest position of its grid.
    void set_axes_mm(glm::dvec2 axes_mm);
    void set_lamp(bool is_on, double voltage_v);
    double lamp_current_a() const;
    double illuminance_lx() const;

    /// A frame of the sensor. Moves the lab's time on where it is fast.
    std::vector<std::uint16_t> expose(double exposure_us, double gain_db);

  private:
    double time_locked_s() const;

    gige::Lab lab_;
    Mounting mounting_;
    bool is_fast_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    mutable std::mutex mutex_;
    gige::Stage stage_;
    double skipped_s_ = 0, lamp_on_s_ = 0, voltage_v_ = 0;
    std::uint64_t frames_of_shot_ = 0;
};

}  // namespace nearfield::devices
