// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <string>

namespace nearfield::app {

/// One line on stderr that says how far a stage is and how long it still takes; nothing where
/// stderr is no terminal.
class ProgressLine {
  public:
    explicit ProgressLine(std::string name);
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// From any thread; draws ten times a second at most. state: what else there is to say.
    void update(double fraction, const std::string& state = "");
    /// Clears the line.
    void finish();

  private:
    std::string name_;
    std::mutex mutex_;
    double start_s_ = 0, drawn_s_ = 0;
    bool visible_ = false, drawn_ = false;
};

}  // namespace nearfield::app
