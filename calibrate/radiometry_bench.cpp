// SPDX-License-Identifier: Apache-2.0
#include "calibrate/radiometry.h"
#include "calibrate/radiometry_flags.h"
#include "formats/rig/veil.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace nearfield::calibrate {
namespace {

// A group of the filter's frames, over the flats of the same source.
FilterPicture filter_picture_of(const ExposureGroup& group,
                                const FrameReader& read,
                                const RadiometryResult& result) {
    const FrameStack stack = stack_of(group, result.layout, read);
    const double t_s = group.exposure_us * 1e-6;
    const rig::Radiometry& radiometry = result.radiometry;
    const double read_dn2 = radiometry.read_noise_dn * radiometry.read_noise_dn;
    const double dark_dn = result.dark.sigma_dn(t_s);
    FilterPicture picture;
    picture.position = group.frames.front()->shot.position;
    picture.sigma.resize(stack.mean_dn.size());
    std::vector<float> rate(stack.mean_dn.size());
    float before = 0.0F;
    for (std::size_t k = 0; k < rate.size(); ++k) {
        const float net_dn = stack.mean_dn[k] - result.maps.black_dn[k] -
                             result.maps.dark_dn_per_s[k] * static_cast<float>(t_s);
        rate[k] = result.maps.is_bad[k] != 0.0F ? before : net_dn / static_cast<float>(t_s);
        before = rate[k];
    }
    picture.transmission = rig::remove_veil(rate, result.layout.size_px, radiometry);
    for (std::size_t k = 0; k < rate.size(); ++k) {
        const double flat =
            result.maps.response[k] *
            result.flat->rate_dn_per_s[static_cast<std::size_t>(result.layout.color(k))];
        picture.transmission[k] /= static_cast<float>(flat);
        if (result.maps.is_bad[k] != 0.0F || stack.mean_dn[k] >= radiometry.saturation_dn)
            continue;
        const double signal_dn = std::max(0.0, static_cast<double>(rate[k]) * t_s);
        const double counts =
            std::sqrt((read_dn2 + signal_dn / radiometry.gain_e_per_dn) / stack.count +
                      dark_dn * dark_dn) /
            (t_s * flat);
        picture.sigma[k] = static_cast<float>(
            std::hypot(counts, picture.transmission[k] * result.maps.response_sigma_rel[k]));
    }
    return picture;
}

}  // namespace

std::vector<FilterView> measure_filter(std::span<const ExposureGroup> views,
                                       const FilterGeometry& geometry,
                                       const Profile& nominal,
                                       const FrameReader& read,
                                       RadiometryResult& result) {
    std::vector<FilterPicture> pictures;
    pictures.reserve(views.size());
    for (const ExposureGroup& group : views)
        pictures.push_back(filter_picture_of(group, read, result));
    std::vector<int> color_of(result.layout.value_count());
    for (std::size_t k = 0; k < color_of.size(); ++k)
        color_of[k] = result.layout.color(k);
    result.filter =
        filter_profile_of(pictures, geometry, nominal, result.layout.colors(), color_of);
    const FilterProfileResult& filter = *result.filter;
    result.radiometry.filter_profile = filter.profile;
    result.radiometry.filter_pitch_m = geometry.pitch_m;
    for (int color = 0; color < 3; ++color) {
        const auto from = static_cast<std::size_t>(result.layout.colors() == 1 ? 0 : color);
        result.radiometry.filter_peak[color] = filter.peak[from];
    }
    for (std::size_t color = 0; color < filter.peak.size(); ++color)
        result.parameters.push_back(
            {fmt::format("filter_peak_{}", color), filter.peak[color], filter.peak_sigma[color]});
    result.parameters.push_back({"filter_turn_in_u_rad", filter.turn_rad, filter.turn_sigma_rad});
    flag_filter(result);
    std::vector<FilterView> centers;
    for (const FilterCenter& center : filter.centers)
        centers.push_back({center.position, center.center_px, center.covariance_px2});
    return centers;
}

void measure_scale(const capture::Capture& capture,
                   const std::optional<PhotometerPlace>& photometer,
                   const RadiometryOptions& options,
                   const FrameReader& read,
                   const RadiometryProgress& progress,
                   RadiometryResult& result) {
    const auto start = std::chrono::steady_clock::now();
    const SortedFrames frames = sorted_frames(capture);
    if (progress)
        progress("scale", 0.0);
    rig::Radiometry& radiometry = result.radiometry;
    if (photometer)
        result.scale =
            fit_scale(scale_points_of(frames.brackets, frames.darks, result.layout, result.dark,
                                      radiometry, result.maps, *photometer, read),
                      photometer->reading_sigma_rel);
    if (result.scale) {
        radiometry.is_absolute = true;
        radiometry.scale_lx_s_per_dn =
            options.photometer_correction * result.scale->scale_lx_s_per_dn;
        radiometry.scale_sigma_rel = result.scale->sigma_rel;
        radiometry.scale_systematic_rel = options.photometer_mismatch_rel;
        result.parameters.push_back({"scale_lx_s_per_dn", radiometry.scale_lx_s_per_dn,
                                     result.scale->sigma_rel * radiometry.scale_lx_s_per_dn});
    }
    if (progress)
        progress("stray light", 0.7);
    double flat_rate = 0;
    for (const double rate : result.flat ? result.flat->rate_dn_per_s : std::vector<double>{})
        flat_rate = std::max(flat_rate, rate);
    std::optional<Profile> profile;
    if (result.filter)
        profile = result.filter->profile;
    result.stray =
        stray_of(frames.brackets, frames.darks, result.layout, result.dark, radiometry, result.maps,
                 flat_rate, profile, result.filter ? result.filter->peak[0] : 1.0, read);
    radiometry.stray_lx =
        result.stray.is_room_measured ? result.stray.room_lx : result.stray.room_bound_lx;
    if (result.stray.is_room_measured)
        result.parameters.push_back({"stray_lx", result.stray.room_lx, result.stray.room_sigma_lx});
    flag_scale(result);
    result.time_s +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace nearfield::calibrate
