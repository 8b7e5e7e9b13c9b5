// SPDX-License-Identifier: Apache-2.0
/// The keys of a rig's file, said once for reading and writing (formats/files/json_visit.h).
#pragma once

#include "formats/rig/rig.h"

#include <array>
#include <utility>

namespace nearfield::rig {

inline constexpr std::array<std::pair<LensModel, const char*>, 3> kLensModels = {
    {{LensModel::Brown5, "brown5"},
     {LensModel::Brown8, "brown8"},
     {LensModel::Fisheye, "fisheye"}}};

constexpr const auto& words_of(LensModel) {
    return kLensModels;
}

template <typename Visit>
void visit_fields(Visit& visit, Lens& lens) {
    visit("model", lens.model);
    visit("size_px", lens.size_px);
    visit("fx_px", lens.fx_px);
    visit("fy_px", lens.fy_px);
    visit("cx_px", lens.cx_px);
    visit("cy_px", lens.cy_px);
    visit("distortion", lens.distortion);
}

template <typename Visit>
void visit_fields(Visit& visit, Planes& planes) {
    visit("camera_from_slab", planes.camera_from_slab);
    visit("delta_m", planes.delta_m);
    visit("u_tilt_rad", planes.u_tilt_rad);
    visit("grid", planes.grid);
    visit("pitch_m", planes.pitch_m);
    visit("skew_rad", planes.skew_rad);
    visit("filter_turn_rad", planes.filter_turn_rad);
    visit("position_m", planes.position_m);
}

template <typename Visit>
void visit_fields(Visit& visit, Parameter& parameter) {
    visit("name", parameter.name);
    visit("value", parameter.value);
    visit("sigma", parameter.sigma);
}

template <typename Visit>
void visit_fields(Visit& visit, TrueExposure& exposure) {
    visit("asked_us", exposure.asked_us);
    visit("true_us", exposure.true_us);
    visit("sigma_rel", exposure.sigma_rel);
}

template <typename Visit>
void visit_fields(Visit& visit, Curve& curve) {
    visit("x", curve.x);
    visit("y", curve.y);
}

template <typename Visit>
void visit_fields(Visit& visit, Radiometry& radiometry) {
    visit("bits", radiometry.bits);
    visit("mosaic", radiometry.mosaic);
    visit("saturation_dn", radiometry.saturation_dn);
    visit("gain_e_per_dn", radiometry.gain_e_per_dn);
    visit("gain_sigma", radiometry.gain_sigma);
    visit("read_noise_dn", radiometry.read_noise_dn);
    visit("prnu_sigma_rel", radiometry.prnu_sigma_rel);
    visit("dark_temperature_c", radiometry.dark_temperature_c);
    visit("linearity_rel", radiometry.linearity_rel);
    visit("linear", radiometry.linear);
    visit("exposures", radiometry.exposures);
    visit("veil_share", radiometry.veil_share);
    visit("veil_sigma_px", radiometry.veil_sigma_px);
    visit("screen", radiometry.screen);
    visit("stray_lx", radiometry.stray_lx);
    visit("scale_lx_s_per_dn", radiometry.scale_lx_s_per_dn);
    visit("scale_sigma_rel", radiometry.scale_sigma_rel);
    visit("scale_systematic_rel", radiometry.scale_systematic_rel);
    visit("is_absolute", radiometry.is_absolute);
    visit("rgb_from_raw", radiometry.rgb_from_raw);
    visit("filter_profile", radiometry.filter_profile);
    visit("filter_pitch_m", radiometry.filter_pitch_m);
    visit("filter_peak", radiometry.filter_peak);
}

template <typename Visit>
void visit_fields(Visit& visit, Rig& rig) {
    visit("lens", rig.lens);
    visit("planes", rig.planes);
    visit("radiometry", rig.radiometry);
    visit("parameters", rig.parameters);
    visit("covariance_of", rig.covariance_of);
    visit("covariance", rig.covariance);
}

}  // namespace nearfield::rig
