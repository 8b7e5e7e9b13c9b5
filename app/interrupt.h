// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <thread>

namespace nearfield::app {

/// Exit code of a command that Ctrl-C (SIGINT) or SIGTERM ended, as shells have it.
constexpr int kExitInterrupted = 130;

/// While it lives, Ctrl-C asks the work to stop instead of ending the program. Work that does not
/// come back within 0.8 s, such as a driver's call that waits for a camera that is gone, is left
/// behind: the program says so and ends; what is on disk is whole at any moment. One at a time.
class Interrupt {
  public:
    explicit Interrupt(const char* last_words);
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    static bool requested();

  private:
    std::jthread watcher_;
};

}  // namespace nearfield::app
