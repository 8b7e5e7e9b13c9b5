// SPDX-License-Identifier: Apache-2.0
#include "acquire/lamp_supply.h"

#include "acquire/settings.h"
#include "formats/files/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace nearfield::acquire {

void SteadyCheck::add(double time_s, double reading) {
    readings_.emplace_back(time_s, reading);
    while (readings_.size() > 2 && readings_[1].first <= time_s - window_s_)
        readings_.pop_front();
}

double SteadyCheck::change_rel() const {
    const auto by_value = [](const auto& a, const auto& b) { return a.second < b.second; };
    const auto [least, most] = std::minmax_element(readings_.begin(), readings_.end(), by_value);
    const double middle = 0.5 * (least->second + most->second);
    return middle > 0 ? (most->second - least->second) / middle : 1;
}

bool SteadyCheck::is_steady() const {
    return !readings_.empty() && readings_.back().first - readings_.front().first >= window_s_ &&
           change_rel() <= limit_rel_;
}

LampSupply::LampSupply(const capture::SupplyPlan& plan) : plan_(plan), instrument_(plan.device) {
    instrument_.write(fmt::format("VOLT {:.4f}", plan.voltage_v));
    instrument_.write(fmt::format("CURR {:.4f}", plan.current_limit_a));
    instrument_.check_errors();
    check_taken("lamp's voltage, V", plan.voltage_v, instrument_.number("VOLT?"), 1e-3);
    check_taken("lamp's current limit, A", plan.current_limit_a, instrument_.number("CURR?"), 1e-3);
}

LampSupply::~LampSupply() {
    try {
        instrument_.write("OUTP OFF");
    } catch (const Error&) {
        return;  // gone: it cannot be reached
    }
}

void LampSupply::set_lamp(bool is_on,
                          const std::function<double()>& watched,
                          const ShouldStop& should_stop) {
    if (is_known_ && is_on == is_on_)
        return;
    is_known_ = false;
    instrument_.write(is_on ? "OUTP ON" : "OUTP OFF");
    instrument_.check_errors();
    check_taken("lamp's output", is_on ? 1 : 0, instrument_.number("OUTP?"), 0);
    if (is_on)
        warm_up(watched, should_stop);
    is_on_ = is_on;
    is_known_ = true;
}

void LampSupply::warm_up(const std::function<double()>& watched, const ShouldStop& should_stop) {
    constexpr double kLooks = 20;  // within the window
    const double start_s = now_s(), between_s = plan_.warm_window_s / kLooks;
    SteadyCheck check(plan_.warm_limit_rel, plan_.warm_window_s);
    for (double next_s = start_s; !check.is_steady();) {
        if (should_stop())
            throw Stopped{};
        const double time_s = now_s();
        if (time_s > start_s + plan_.warm_most_s)
            throw Error{
                "the lamp does not get steady", plan_.device,
                fmt::format("a change of {:g} % in {:g} s", 100 * plan_.warm_limit_rel,
                            plan_.warm_window_s),
                fmt::format("{:.3g} % after {:.0f} s", 100 * check.change_rel(), time_s - start_s)};
        if (time_s < next_s) {
            std::this_thread::sleep_for(
                std::chrono::duration<double>(std::min(next_s - time_s, 0.05)));
            continue;
        }
        next_s = time_s + between_s;
        check.add(time_s, watched());
    }
    const double current_a = this->current_a();
    if (current_a >= 0.999 * plan_.current_limit_a)
        throw Error{
            "the lamp draws the limit's current", plan_.device,
            fmt::format("less than {:g} A at {:g} V", plan_.current_limit_a, plan_.voltage_v),
            fmt::format("{:g} A at {:g} V", current_a, voltage_v())};
}

}  // namespace nearfield::acquire
