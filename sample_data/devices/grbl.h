// SPDX-License-Identifier: Apache-2.0
/// A stage's GRBL controller on a pseudo-terminal.
///
/// Understands: reset (0x18), ?, !, ~, $$, $H, $X, and G1 with X, Y, F in machine coordinates
/// (G21 G90 G94 G53). Moves take their time at the feed; homing 20 ms.
#pragma once

#include "sample_data/devices/lab_state.h"
#include "sample_data/devices/test_bed.h"

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

namespace nearfield::devices {

/// Misbehavior for tests. Zeros: none.
struct GrblFaults {
    std::atomic<bool> fails_homing{false};  // ALARM:9
    std::atomic<double> switch_at_mm{0};    // a limit switch is hit where X falls below; 0: none
    std::atomic<double> lost_steps_mm{0};   // what X falls short of its target
    std::atomic<bool> is_stuck{false};      // moves never end
    std::atomic<bool> is_silent{false};     // answers nothing
};

class Grbl {
  public:
    Grbl(TestBed& bed, LabState& lab, int number);
    ~Grbl();
    Grbl(const Grbl&) = delete;
    Grbl& operator=(const Grbl&) = delete;

    /// Pulls the plug: the line hangs up.
    void unplug();
    /// Once: a fresh line of the same name. The controller is where it was, and locked.
    void plug_in();

    GrblFaults faults;
    double speed_up = 1;  // of moves; set before anybody listens

  private:
    void run();
    void say(const std::string& line);
    void take(char character);
    void obey(const std::string& line);
    void start_move(const std::string& line);
    void reset();
    void home();
    void finish_move();
    void alarm(int number);
    std::string report() const;
    glm::dvec2 position_mm() const;

    LabState& lab_;
    std::string node_;  // the test bed's file of the device
    int terminal_ = -1, second_terminal_ = -1;
    std::atomic<bool> is_ending_{false};
    // Of the thread alone.
    std::string line_, state_ = "Alarm";
    glm::dvec2 from_mm_{0}, to_mm_{0};
    std::chrono::steady_clock::time_point start_;
    double duration_s_ = 0;
    std::thread thread_;
};

}  // namespace nearfield::devices
