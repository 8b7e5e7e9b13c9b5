// SPDX-License-Identifier: Apache-2.0
#include "calibrate/radiometry_flags.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::calibrate {
namespace {

constexpr double kChi2Sigmas = 5.0;

void flag(RadiometryResult& result, std::string what, std::string advice) {
    result.flags.push_back({std::move(what), std::move(advice)});
}

bool is_too_large(double chi2, int freedom) {
    return freedom > 0 && chi2 > freedom + kChi2Sigmas * std::sqrt(2.0 * freedom);
}

void flag_dark(const SortedFrames& frames, RadiometryResult& result) {
    const DarkResult& dark = result.dark;
    if (dark.points.size() == 1)
        flag(result, "darks at one exposure only: dark current is taken as 0",
             "take darks at the shortest and the longest exposure");
    if (dark.share_clipped > 0.01)
        flag(result, fmt::format("{:.1f} % of dark values are 0", 100.0 * dark.share_clipped),
             "raise the camera's black level: noise that is cut off makes dark light too bright");
    constexpr double kMostSpread_c = 2.0;
    if (dark.temperature_spread_c > kMostSpread_c && !dark.is_room_known)
        flag(result,
             fmt::format("the sensor's temperature changed by {:.1f} C during the darks",
                         dark.temperature_spread_c),
             "let the camera warm up; dark current doubles every 6 to 8 C");
    double most_off_c = 0;
    for (const Bracket& bracket : frames.brackets) {
        for (const capture::FrameRecord* frame : bracket) {
            if (frame->temperature_c && dark.has_temperature)
                most_off_c =
                    std::max(most_off_c, std::abs(*frame->temperature_c - dark.temperature_c));
        }
    }
    constexpr double kMostOff_c = 5.0;
    if (most_off_c > kMostOff_c + (dark.is_room_known ? dark.temperature_spread_c : 0.0))
        flag(result,
             fmt::format("lights were taken up to {:.1f} C off the darks' temperature", most_off_c),
             "take darks after the lights too (darks_after_per_exposure), or let the camera warm "
             "up");
}

}  // namespace

void flag_sensor(const SortedFrames& frames, RadiometryResult& result) {
    flag_dark(frames, result);
    if (result.noise && is_too_large(result.noise->chi2, result.noise->freedom))
        flag(result,
             fmt::format("noise against light is no straight line: chi-square {:.0f} of {}",
                         result.noise->chi2, result.noise->freedom),
             "check that flats are raw values and that their source does not flicker");
    if (!result.saturation.is_reached)
        flag(result, "no frame is saturated: the range's end is assumed to be light's end",
             "take one flat or light that is too bright, so that a full well below it would show");
    if (result.flat && result.flat->linearity.size() < 2)
        flag(result, "flats at one exposure only: linearity is not checked",
             "take flats at three exposures or more");
    if (result.flat && !result.flat->linear.x.empty())
        flag(result,
             fmt::format("the camera is {:.1f} % off a straight line; a curve corrects it",
                         100.0 * result.flat->linearity_rel),
             "check the flats' source for drift: it would look the same");
    for (const ExposureRatio& ratio : result.ratios.ratios) {
        const double off = ratio.ratio / (ratio.longer_us / ratio.shorter_us) - 1.0;
        if (std::abs(off) > 0.005 && std::abs(off) > kChi2Sigmas * ratio.sigma_rel)
            flag(result,
                 fmt::format("{:.0f} us is {:+.2f} % off what was asked for beside {:.0f} us",
                             ratio.longer_us, 100.0 * off, ratio.shorter_us),
                 "nothing: the true exposure is used");
        if (ratio.drift_rel > 0.005)
            flag(result,
                 fmt::format("the lamp changes by {:.2f} % between {:.0f} and {:.0f} us",
                             100.0 * ratio.drift_rel, ratio.shorter_us, ratio.longer_us),
                 "let the lamp warm up, or take the bracket faster");
    }
    if (result.ratios.ratios.size() + 1 < result.ratios.exposures.size())
        flag(result, "neighboring exposures without pixels that are well exposed in both",
             "take exposures at most a factor 8 apart");
    if (!result.veil.is_significant)
        flag(result, "the lens' veil was not found: none is assumed",
             "let boards be seen before a black backdrop, well exposed");
}

void flag_filter(RadiometryResult& result) {
    const FilterProfileResult& filter = *result.filter;
    if (filter.asymmetry_sigmas > kChi2Sigmas && filter.asymmetry > 0.005)
        flag(result,
             fmt::format("the filter differs along x and y by {:.2f} % of its peak",
                         100.0 * filter.asymmetry),
             "give its pitch along both axes; one profile is used for both");
    if (filter.nominal_sigmas > kChi2Sigmas && filter.nominal_deviation > 0.02)
        flag(result,
             fmt::format("the filter's profile is up to {:.1f} % of its peak off the nominal one",
                         100.0 * filter.nominal_deviation),
             "nothing: the measured profile is used");
}

void flag_scale(RadiometryResult& result) {
    if (!result.scale) {
        flag(result, "no photometer readings beside lit frames: light is relative",
             "log a photometer that lies in S, and say where (plan: photometer)");
        return;
    }
    const ScaleResult& scale = *result.scale;
    if (is_too_large(scale.chi2, scale.freedom))
        flag(result,
             fmt::format("photometer and camera do not agree: chi-square {:.0f} of {}", scale.chi2,
                         scale.freedom),
             "check where the photometer lies, and its noise in the plan; a camera that sees "
             "other colors than the eye disagrees as well where the lamp's color changes");
    if (scale.offset_lx < -kChi2Sigmas * scale.offset_sigma_lx)
        flag(result, fmt::format("the photometer reads {:.3g} lx without light", scale.offset_lx),
             "set the photometer's zero");
}

void list_sensor(RadiometryResult& result) {
    const auto list = [&](const char* name, double value, double sigma) {
        result.parameters.push_back({name, value, sigma});
    };
    if (result.noise) {
        list("gain_e_per_dn", result.noise->gain_e_per_dn, result.noise->gain_sigma);
        list("read_noise_dn", result.noise->read_noise_dn, result.noise->read_noise_sigma);
    }
    if (result.veil.is_significant) {
        list("veil_share", result.veil.share, result.veil.share_sigma);
        list("veil_sigma_px", result.veil.sigma_px, result.veil.sigma_sigma_px);
    }
    for (const ExposureRatio& ratio : result.ratios.ratios)
        list(fmt::format("exposure_ratio_{:.0f}_{:.0f}_us", ratio.longer_us, ratio.shorter_us)
                 .c_str(),
             ratio.ratio, ratio.sigma_rel * ratio.ratio);
}

}  // namespace nearfield::calibrate
