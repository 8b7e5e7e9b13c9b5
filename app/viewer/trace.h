// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/panels.h"

#include <nlohmann/json_fwd.hpp>

#include <fstream>
#include <map>
#include <string>

namespace nearfield::viewer {

/// What is done and how long it takes, as JSON lines: for tests and for measuring. Times are
/// milliseconds since the first line, which has the machine's monotonic clock. Does nothing without
/// a path.
class Trace {
  public:
    explicit Trace(const std::string& path);

    /// The loop goes on after a sleep: what is asked for from now on was caused by events of this
    /// time.
    void woke();
    /// A request was made of the renderer; a frame that answers it, or a later one, was shown. What
    /// passes between the waking before the one and the other is the feedback's time.
    void asked(const Request& request);
    void showed(const Frame& frame, bool is_final);
    /// What ImGui has of mouse and keys in this frame, where it differs from the last.
    void saw_input();
    /// What is written at the window's lower edge.
    void said(const std::string& message);
    /// Widgets' places, where they differ from the last.
    void placed(const std::map<std::string, glm::vec4>& places);

  private:
    double now_ms() const;
    void write(const nlohmann::json& line);

    std::ofstream file_;
    double start_s_, woke_ms_ = 0;
    std::string input_, message_;     // the last
    std::map<int, double> asked_ms_;  // by serial, until answered
    std::map<std::string, glm::vec4> places_;
};

}  // namespace nearfield::viewer
