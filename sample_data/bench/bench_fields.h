// SPDX-License-Identifier: Apache-2.0
/// The JSON keys of a bench, said once for reading and writing: visit_fields calls
/// visit(key, member) for every member.
#pragma once

#include "sample_data/bench/bench.h"

namespace nearfield::sample_data {

template <typename Visit>
void visit_fields(Visit& visit, BenchLamp& lamp) {
    visit("file", lamp.file);
    visit("headlight_seed", lamp.headlight_seed);
    visit("u_from_lamp", lamp.u_from_lamp);
    visit("warm_up_rel", lamp.warm_up_rel);
    visit("warm_up_s", lamp.warm_up_s);
    visit("walk_sigma_rel", lamp.walk_sigma_rel);
    visit("walk_s", lamp.walk_s);
}

template <typename Visit>
void visit_fields(Visit& visit, BenchFilter& filter) {
    visit("profile", filter.profile);
    visit("grid", filter.grid);
    visit("pitch_m", filter.pitch_m);
    visit("center_m", filter.center_m);
    visit("transmission", filter.transmission);
    visit("hole_radius_m", filter.hole_radius_m);
    visit("tilt_deg", filter.tilt_deg);
    visit("stage_scale", filter.stage_scale);
    visit("stage_skew_deg", filter.stage_skew_deg);
    visit("step_sigma_m", filter.step_sigma_m);
}

template <typename Visit>
void visit_fields(Visit& visit, BenchScreen& screen) {
    visit("min_m", screen.min_m);
    visit("max_m", screen.max_m);
    visit("tilt_deg", screen.tilt_deg);
    visit("reflectance", screen.reflectance);
    visit("lobe_share", screen.lobe_share);
    visit("lobe_exponent", screen.lobe_exponent);
}

template <typename Visit>
void visit_fields(Visit& visit, BenchCamera& camera) {
    visit("size_px", camera.size_px);
    visit("mosaic", camera.mosaic);
    visit("bits", camera.bits);
    visit("fx_px", camera.fx_px);
    visit("fy_px", camera.fy_px);
    visit("cx_px", camera.cx_px);
    visit("cy_px", camera.cy_px);
    visit("k1", camera.k1);
    visit("k2", camera.k2);
    visit("p1", camera.p1);
    visit("p2", camera.p2);
    visit("k3", camera.k3);
    visit("bench_from_camera", camera.bench_from_camera);
    visit("vignetting_cos4", camera.vignetting_cos4);
    visit("vignetting", camera.vignetting);
    visit("psf_sigma_px", camera.psf_sigma_px);
    visit("veil_share", camera.veil_share);
    visit("veil_sigma_px", camera.veil_sigma_px);
    visit("response_e_per_cd_m2_s", camera.response_e_per_cd_m2_s);
    visit("gain_e_per_dn", camera.gain_e_per_dn);
    visit("full_well_e", camera.full_well_e);
    visit("read_noise_e", camera.read_noise_e);
    visit("black_level_dn", camera.black_level_dn);
    visit("dark_e_per_s", camera.dark_e_per_s);
    visit("dark_reference_c", camera.dark_reference_c);
    visit("dark_doubling_c", camera.dark_doubling_c);
    visit("sensor_start_c", camera.sensor_start_c);
    visit("sensor_rise_c", camera.sensor_rise_c);
    visit("sensor_rise_s", camera.sensor_rise_s);
    visit("prnu_sigma_rel", camera.prnu_sigma_rel);
    visit("dsnu_sigma_rel", camera.dsnu_sigma_rel);
    visit("offset_sigma_dn", camera.offset_sigma_dn);
    visit("hot_share", camera.hot_share);
    visit("hot_factor", camera.hot_factor);
}

template <typename Visit>
void visit_fields(Visit& visit, BenchStray& stray) {
    visit("veil_lx", stray.veil_lx);
    visit("blocked_share", stray.blocked_share);
}

template <typename Visit>
void visit_fields(Visit& visit, BenchPhotometer& photometer) {
    visit("position_m", photometer.position_m);
    visit("normal", photometer.normal);
    visit("channel_factor", photometer.channel_factor);
    visit("sigma_rel", photometer.sigma_rel);
    visit("sigma_lx", photometer.sigma_lx);
}

template <typename Visit>
void visit_fields(Visit& visit, BenchBoard& board) {
    visit("squares", board.squares);
    visit("square_m", board.square_m);
    visit("marker_m", board.marker_m);
    visit("margin_m", board.margin_m);
    visit("black", board.black);
    visit("white", board.white);
}

template <typename Visit>
void visit_fields(Visit& visit, TargetView& view) {
    visit("plane", view.plane);
    visit("plane_from_board", view.plane_from_board);
}

template <typename Visit>
void visit_fields(Visit& visit, BenchTargets& targets) {
    visit("board", targets.board);
    visit("views", targets.views);
    visit("hand_sigma_deg", targets.hand_sigma_deg);
    visit("hand_sigma_m", targets.hand_sigma_m);
    visit("room_lx", targets.room_lx);
}

template <typename Visit>
void visit_fields(Visit& visit, BenchAccuracy& accuracy) {
    visit("lens_step", accuracy.lens_step);
    visit("screen_step_px", accuracy.screen_step_px);
    visit("subsamples", accuracy.subsamples);
}

template <typename Visit>
void visit_fields(Visit& visit, Bench& bench) {
    visit("seed", bench.seed);
    visit("setup", bench.setup);
    visit("delta_m", bench.delta_m);
    visit("lamp", bench.lamp);
    visit("filter", bench.filter);
    visit("screen", bench.screen);
    visit("camera", bench.camera);
    visit("stray", bench.stray);
    visit("photometer", bench.photometer);
    visit("targets", bench.targets);
    visit("flat_cd_m2", bench.flat_cd_m2);
    visit("accuracy", bench.accuracy);
}

}  // namespace nearfield::sample_data
