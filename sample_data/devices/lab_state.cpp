// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/lab_state.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::devices {

LabState::LabState(gige::Lab lab, Mounting mounting, bool fast)
    : lab_(std::move(lab)), mounting_(mounting), is_fast_(fast) {
    stage_.lamp_on = false;
}

double LabState::time_locked_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count() +
           skipped_s_;
}

double LabState::time_s() const {
    const std::lock_guard lock(mutex_);
    return time_locked_s();
}

void LabState::set_subject(gige::Subject subject) {
    const std::lock_guard lock(mutex_);
    stage_.subject = subject;
}

void LabState::set_target_view(int view) {
    const std::lock_guard lock(mutex_);
    stage_.target_view = view;
}

void LabState::set_shot(std::uint32_t shot) {
    const std::lock_guard lock(mutex_);
    stage_.shot = shot;
    frames_of_shot_ = 0;
}

gige::Stage LabState::stage() const {
    const std::lock_guard lock(mutex_);
    return stage_;
}

void LabState::set_axes_mm(glm::dvec2 axes_mm) {
    const std::lock_guard lock(mutex_);
    const glm::dvec2 steps = (axes_mm - mounting_.first_position_mm) / mounting_.pitch_mm;
    for (int k = 0; k < 2; ++k)
        stage_.filter[k] =
            std::clamp(static_cast<int>(std::lround(steps[k])), 0, lab_.filter_grid[k] - 1);
}

void LabState::set_lamp(bool is_on, double voltage_v) {
    const std::lock_guard lock(mutex_);
    voltage_v_ = voltage_v;
    if (std::exchange(stage_.lamp_on, is_on) != is_on)
        lamp_on_s_ = time_locked_s();
}

double LabState::lamp_current_a() const {
    const std::lock_guard lock(mutex_);
    if (!stage_.lamp_on)
        return 0;
    const double since_s = time_locked_s() - lamp_on_s_;
    return mounting_.lamp_current_a * voltage_v_ / mounting_.lamp_voltage_v *
           (1 + mounting_.warm_up_rel * std::exp(-since_s / mounting_.warm_up_s));
}

double LabState::illuminance_lx() const {
    const std::unique_lock lock(mutex_);
    return lab_.photometer_lx ? lab_.photometer_lx(stage_, time_locked_s()) : 0;
}

std::vector<std::uint16_t> LabState::expose(double exposure_us, double gain_db) {
    gige::Exposure exposure;
    {
        const std::lock_guard lock(mutex_);
        exposure = {frames_of_shot_++, exposure_us, gain_db, time_locked_s() + exposure_us / 2e6,
                    stage_};
        if (is_fast_)
            skipped_s_ += exposure_us / 1e6;
    }
    return lab_.expose(exposure);
}

}  // namespace nearfield::devices
