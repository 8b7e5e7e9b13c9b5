// SPDX-License-Identifier: Apache-2.0
/// The lamp's programmable supply, and waiting until the lamp is warm.
#pragma once

#include "acquire/usbtmc.h"
#include "formats/capture/instruments.h"

#include <deque>
#include <functional>

namespace nearfield::acquire {

/// Says when a reading has settled: it changed by less than the limit within the window.
class SteadyCheck {
  public:
    SteadyCheck(double limit_rel, double window_s) : limit_rel_(limit_rel), window_s_(window_s) {}

    /// Times must rise.
    void add(double time_s, double reading);
    /// False until readings span the window.
    bool is_steady() const;
    /// Of the readings within the window: (largest - smallest) / mean.
    double change_rel() const;

  private:
    double limit_rel_, window_s_;
    std::deque<std::pair<double, double>>
        readings_;  // time, value; the first is as old as the window
};

class LampSupply {
  public:
    /// Opens, checks that it takes voltage and current limit. The output stays as it is. Throws as
    /// Usbtmc; Error where the supply refuses.
    explicit LampSupply(const capture::SupplyPlan& plan);
    /// Switches the lamp off, as far as the supply answers.
    ~LampSupply();
    LampSupply(const LampSupply&) = delete;
    LampSupply& operator=(const LampSupply&) = delete;

    /// Switches the lamp; on waits until what `watched` reads is steady. Nothing to do is quick.
    /// Throws Error where the lamp draws the limit's current, or is not warm in time.
    void set_lamp(bool is_on,
                  const std::function<double()>& watched,
                  const ShouldStop& should_stop);

    double voltage_v() { return instrument_.number("MEAS:VOLT?"); }
    double current_a() { return instrument_.number("MEAS:CURR?"); }
    const std::string& identity() const { return instrument_.identity(); }

  private:
    void warm_up(const std::function<double()>& watched, const ShouldStop& should_stop);

    capture::SupplyPlan plan_;
    Usbtmc instrument_;
    bool is_on_ = false, is_known_ = false;
};

}  // namespace nearfield::acquire
