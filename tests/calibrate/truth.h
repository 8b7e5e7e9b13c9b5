// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/calibrate/simulated.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>

namespace nearfield::test {

/// What a parameter of the geometry should be.
inline double true_parameter(const SimulatedBench& bench, const std::string& name) {
    const rig::Lens& lens = bench.lens;
    const bool is_fisheye = lens.model == rig::LensModel::Fisheye;
    const std::vector<std::string> distortion =
        is_fisheye ? std::vector<std::string>{"k1", "k2", "k3", "k4"}
                   : std::vector<std::string>{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    const auto found = std::find(distortion.begin(), distortion.end(), name);
    if (found != distortion.end())
        return lens.distortion[static_cast<std::size_t>(std::distance(distortion.begin(), found))];
    const glm::dvec3 origin = bench.camera_from_slab.translation_m;
    const std::vector<std::pair<std::string, double>> values = {
        {"fx_px", lens.fx_px},
        {"fy_px", lens.fy_px},
        {"cx_px", lens.cx_px},
        {"cy_px", lens.cy_px},
        {"delta_m", bench.delta_m},
        {"u_tilt_x_rad", bench.u_tilt_rad.x},
        {"u_tilt_y_rad", bench.u_tilt_rad.y},
        {"pitch_x_m", bench.pitch_m.x},
        {"pitch_y_m", bench.pitch_m.y},
        {"skew_rad", bench.skew_rad},
        {"slab_x_m", origin.x},
        {"slab_y_m", origin.y},
        {"slab_z_m", origin.z},
    };
    for (const auto& [key, value] : values) {
        if (key == name)
            return value;
    }
    throw std::runtime_error("no truth for " + name);
}

/// The small turn (rad, about the slab's axes) from what was found to the truth.
inline glm::dvec3 slab_turn_rad(const SimulatedBench& bench, const Rigid& camera_from_slab) {
    const glm::dmat3 turn =
        glm::transpose(camera_from_slab.rotation) * bench.camera_from_slab.rotation;
    return 0.5 * glm::dvec3(turn[1].z - turn[2].y, turn[2].x - turn[0].z, turn[0].y - turn[1].x);
}

/// The same for a geometry's parameter, whose turns are 0 where it is: slab_turn_x_rad is what the
/// truth is away from it.
inline double true_parameter(const SimulatedBench& bench,
                             const std::string& name,
                             const Rigid& camera_from_slab) {
    const glm::dvec3 turn = slab_turn_rad(bench, camera_from_slab);
    if (name == "slab_turn_x_rad")
        return turn.x;
    if (name == "slab_turn_y_rad")
        return turn.y;
    if (name == "slab_turn_z_rad")
        return turn.z;
    return true_parameter(bench, name);
}

}  // namespace nearfield::test
