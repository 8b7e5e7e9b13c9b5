// SPDX-License-Identifier: Apache-2.0
/// A lab of simulated devices before a bench whose frames tell how they were taken.
#pragma once

#include "acquire/camera.h"
#include "sample_data/devices/virtual_lab.h"

#include <functional>
#include <vector>

namespace nearfield::devices {

inline const glm::ivec2 kSensorPx{64, 48};
inline const glm::dvec2 kFirst_mm{-100, -90};
inline const glm::dvec2 kPitch_mm{16, 12};

inline bool never() {
    return false;
}

/// The value of a pixel of the test bench: of everything that a frame depends on.
inline std::uint16_t test_value(const gige::Exposure& exposure, std::size_t pixel) {
    const double light = exposure.stage.lamp_on ? exposure.exposure_us / 100 : 0;
    return static_cast<std::uint16_t>(
        (static_cast<std::size_t>(light) + pixel % 97 + 7 * exposure.frame_number +
         13 * static_cast<std::size_t>(exposure.stage.filter.x + 5 * exposure.stage.filter.y) +
         31 * exposure.stage.shot + 101 * static_cast<std::size_t>(exposure.stage.subject) +
         static_cast<std::size_t>(10 * exposure.gain_db)) %
        4096);
}

inline std::vector<std::uint16_t> test_frame(const gige::Exposure& exposure) {
    std::vector<std::uint16_t> values(static_cast<std::size_t>(kSensorPx.x * kSensorPx.y));
    for (std::size_t k = 0; k < values.size(); ++k)
        values[k] = test_value(exposure, k);
    return values;
}

inline gige::Lab test_bench() {
    gige::Lab lab;
    lab.sensor_px = kSensorPx;
    lab.filter_grid = {5, 4};
    lab.target_views = 3;
    lab.expose = test_frame;
    lab.photometer_lx = [](const gige::Stage& stage, double) { return stage.lamp_on ? 123.5 : 0; };
    return lab;
}

inline Mounting test_mounting() {
    Mounting mounting;
    mounting.first_position_mm = kFirst_mm;
    mounting.pitch_mm = kPitch_mm;
    return mounting;
}

/// The error that a call ends with.
template <typename Failure>
std::string complaint(const std::function<void()>& call) {
    try {
        call();
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "no complaint";
}

}  // namespace nearfield::devices
