// SPDX-License-Identifier: Apache-2.0
/// Devices that another program holds. One that was killed gives them back only when its last calls
/// have returned and its files are closed, which may be after it counts as dead.
#pragma once

#include "acquire/camera.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace nearfield::acquire {

/// A driver that waits for its camera's last frames before it lets go is done by then.
constexpr double kBusyPatience_s = 10;

/// How a busy device is waited for.
class Patience {
  public:
    /// `say` is told once that it waits, and for whom.
    Patience(double patience_s, ShouldStop should_stop, std::function<void(const std::string&)> say)
        : patience_s_(patience_s), should_stop_(std::move(should_stop)), say_(std::move(say)) {}

    /// Waits a moment. Throws DeviceBusy when the patience, which begins with the first call, is at
    /// its end; Stopped.
    void wait_after(const DeviceBusy& busy);

  private:
    double patience_s_;
    ShouldStop should_stop_;
    std::function<void(const std::string&)> say_;
    std::optional<double> end_s_;
};

/// What `call` returns, which is called again where a device was busy.
template <typename Call>
auto until_free(const Call& call, Patience patience) {
    while (true) {
        try {
            return call();
        } catch (const DeviceBusy& busy) {
            patience.wait_after(busy);
        }
    }
}

}  // namespace nearfield::acquire
