// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/panels.h"

#include <fstream>
#include <map>
#include <string>

namespace nearfield::viewer {

/// What is done and how long it takes, as JSON lines: for tests and for measuring. Does nothing
/// without a path.
class Trace {
  public:
    explicit Trace(const std::string& path);

    /// A request was made of the renderer; a frame that answers it, or a later one, was shown. What
    /// passes between the two is the feedback's time.
    void asked(int serial);
    void showed(const Frame& frame, bool is_final);
    /// Widgets' places, where they differ from the last.
    void placed(const std::map<std::string, glm::vec4>& places);

  private:
    double now_ms() const;

    std::ofstream file_;
    double start_s_;
    std::map<int, double> asked_ms_;  // by serial, until answered
    std::map<std::string, glm::vec4> places_;
};

}  // namespace nearfield::viewer
