// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/rig/rig.h"

namespace nearfield::rig::test {

/// A rig of 6 x 4 pixels and 3 x 2 filter positions, no value of which equals another.
inline Rig small_rig() {
    Rig rig;
    rig.lens = {
        LensModel::Brown5, {6, 4}, 800.25, 801.5, 3.1, 2.2, {-0.1, 0.09, 4e-4, -3e-4, 0.01}};
    Planes& planes = rig.planes.emplace();
    planes.camera_from_slab = {glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, 1), {0.02, -0.03, 0.8}};
    planes.delta_m = 0.2001;
    planes.u_tilt_rad = {0.002, -0.003};
    planes.grid = {3, 2};
    planes.pitch_m = {0.02, 0.0216};
    planes.skew_rad = 0.0017;
    planes.filter_turn_rad = -0.0005;
    for (int k = 0; k < 6; ++k) {
        const int row = k / 3;
        planes.position_m.emplace_back(0.02 * (k % 3) - 0.02, 0.0216 * row, -0.2 - 1e-5 * k);
    }
    Radiometry& radiometry = rig.radiometry.emplace();
    radiometry.bits = 12;
    radiometry.mosaic = "rggb";
    radiometry.saturation_dn = 3900;
    radiometry.gain_e_per_dn = 2.7;
    radiometry.gain_sigma = 0.01;
    radiometry.read_noise_dn = 2.1;
    radiometry.dark_temperature_c = 31.5;
    radiometry.linear = {{0, 2048, 4095}, {0, 2050, 4100}};
    radiometry.exposures = {{2000, 2001.5, 1e-4}, {8000, 7999, 2e-4}};
    radiometry.veil_share = 0.005;
    radiometry.veil_sigma_px = 48;
    radiometry.screen = {{0, 0.5}, {1, 0.97}};
    radiometry.scale_lx_s_per_dn = 1.0 / 3.0;
    radiometry.scale_sigma_rel = 0.001;
    radiometry.scale_systematic_rel = 0.02;
    radiometry.is_absolute = true;
    radiometry.rgb_from_raw = {1.5, -0.3, 0.01, -0.4, 1.4, -0.5, -0.1, -0.1, 1.6};
    radiometry.filter_profile = {"measured", {{0.5, 0.5, 0.0}, {0.5, -0.5, 0.001}}};
    radiometry.filter_pitch_m = {0.02, 0.0216};
    radiometry.filter_peak = {0.9, 0.91, 0.88};
    rig.parameters = {{"delta_m", 0.2001, 2e-5}, {"pitch_x_m", 0.02, 1e-6}};
    rig.covariance_of = {"delta_m", "pitch_x_m"};
    rig.covariance = {4e-10, 1e-13, 1e-13, 1e-12};
    rig.provenance.program = "nearfield 0";
    rig.provenance.command = "calibrate";
    return rig;
}

inline Maps small_maps() {
    Maps maps;
    maps.size_px = {6, 4};
    for (int k = 0; k < 24; ++k) {
        const auto value = static_cast<float>(k);
        maps.black_dn.push_back(48.0F + value / 7.0F);
        maps.dark_dn_per_s.push_back(value / 3.0F);
        maps.room_dn_per_s.push_back(value / 7.0F);
        maps.response.push_back(1.0F - value / 100.0F);
        maps.response_sigma_rel.push_back(value / 1000.0F);
        maps.is_bad.push_back(k == 5 ? 1.0F : 0.0F);
    }
    return maps;
}

}  // namespace nearfield::rig::test
