// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sample_data/gige/camera.h"

#include <algorithm>

namespace nearfield::gige {

/// What the test lab's sensor sees at (x, y): 12 bits that depend on the frame's number. Pixel (0,
/// 0) has the exposure time instead, in us and up to 4095, so that a client sees what was applied.
inline std::uint16_t test_value(int x, int y, const Exposure& exposure) {
    if (x == 0 && y == 0)
        return static_cast<std::uint16_t>(std::min(exposure.exposure_us, 4095.0));
    const std::uint64_t mixed = static_cast<std::uint64_t>(x) * 2654435761U +
                                static_cast<std::uint64_t>(y) * 40503U +
                                exposure.frame_number * 977U;
    return static_cast<std::uint16_t>((mixed ^ mixed >> 13U) & 0xFFFU);
}

inline Lab test_lab(glm::ivec2 sensor_px) {
    Lab lab;
    lab.sensor_px = sensor_px;
    lab.filter_grid = {9, 7};
    lab.target_views = 3;
    lab.black_level_dn = 64;
    lab.expose = [sensor_px](const Exposure& exposure) {
        std::vector<std::uint16_t> values;
        values.reserve(static_cast<std::size_t>(sensor_px.x) *
                       static_cast<std::size_t>(sensor_px.y));
        for (int y = 0; y < sensor_px.y; ++y)
            for (int x = 0; x < sensor_px.x; ++x)
                values.push_back(test_value(x, y, exposure));
        return values;
    };
    lab.photometer_lx = [](const Stage& stage, double) {
        return stage.lamp_on ? 100.0 + stage.filter.x + 10.0 * stage.filter.y : 0.5;
    };
    lab.sensor_c = [](double) { return 36.5; };
    return lab;
}

}  // namespace nearfield::gige
