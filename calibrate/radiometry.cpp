// SPDX-License-Identifier: Apache-2.0
#include "calibrate/radiometry.h"

#include "calibrate/radiometry_flags.h"
#include "calibrate/robust.h"
#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace nearfield::calibrate {
namespace {

using capture::FrameRecord;
using capture::ShotKind;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kBrightFrames = 8;  // looked at for where values end

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void report(const RadiometryProgress& progress, const char* step, double fraction) {
    if (progress)
        progress(step, fraction);
}

template <typename Key>
std::vector<ExposureGroup> groups_of(const std::map<Key, ExposureGroup>& by_key) {
    std::vector<ExposureGroup> groups;
    groups.reserve(by_key.size());
    for (const auto& [key, group] : by_key)
        groups.push_back(group);
    return groups;
}

DarkResult assumed_dark(const PixelLayout& layout, double black_dn) {
    DarkResult dark;
    dark.black_dn.assign(layout.value_count(), static_cast<float>(black_dn));
    dark.dark_dn_per_s.assign(layout.value_count(), 0.0F);
    dark.room_dn_per_s.assign(layout.value_count(), 0.0F);
    dark.is_hot.assign(layout.value_count(), 0.0F);
    return dark;
}

void find_dark(const SortedFrames& frames,
               const FrameReader& read,
               const RadiometryOptions& options,
               RadiometryResult& result) {
    if (!frames.darks.empty()) {
        result.dark = dark_of(frames.darks, result.layout, read, options.hot_sigmas);
    } else if (options.assumed_black_dn) {
        result.dark = assumed_dark(result.layout, *options.assumed_black_dn);
        result.flags.push_back(
            {fmt::format("no darks: a black level of {} DN is assumed, dark current is not known",
                         *options.assumed_black_dn),
             "take darks: the lamp off, everything else as it was"});
    } else {
        throw Error{"cannot find the black level", "capture", "frames with the lamp off (darks)",
                    "none; an assumed black level is an option"};
    }
    result.maps.size_px = result.layout.size_px;
    result.maps.black_dn = result.dark.black_dn;
    result.maps.dark_dn_per_s = result.dark.dark_dn_per_s;
    result.maps.room_dn_per_s = result.dark.room_dn_per_s;
    result.maps.is_bad = result.dark.is_hot;
    result.radiometry.dark_temperature_c = result.dark.temperature_c;
}

// Noise from pairs of darks and flats; saturation from flats and the brightest lights.
void find_noise(const SortedFrames& frames, const FrameReader& read, RadiometryResult& result) {
    TransferSums sums(result.layout, result.dark.black_dn, result.dark.is_hot);
    LevelHistogram histogram;
    for (const auto* groups : {&frames.darks, &frames.flats}) {
        for (const ExposureGroup& group : *groups) {
            capture::Frame first;
            for (std::size_t k = 0; k < group.frames.size(); ++k) {
                capture::Frame now = read(*group.frames[k]);
                if (groups == &frames.flats)
                    histogram.add(now);
                if (k % 2 == 1)
                    sums.add(first, now);
                else
                    first = std::move(now);
            }
        }
    }
    std::vector<const FrameRecord*> lights;
    for (const Bracket& bracket : frames.brackets)
        lights.insert(lights.end(), bracket.begin(), bracket.end());
    std::stable_sort(lights.begin(), lights.end(), [](const FrameRecord* a, const FrameRecord* b) {
        return a->mean_dn > b->mean_dn;
    });
    lights.resize(std::min(lights.size(), kBrightFrames));
    for (const FrameRecord* record : lights) {
        require_same(result.layout, *record);
        histogram.add(read(*record));
    }
    const double black_dn = median_of(result.dark.black_dn);
    result.noise = noise_of(sums.points(), result.layout.range_dn() - black_dn);
    rig::Radiometry& radiometry = result.radiometry;
    radiometry.gain_e_per_dn = result.noise->gain_e_per_dn;
    radiometry.gain_sigma = result.noise->gain_sigma;
    radiometry.read_noise_dn = result.noise->read_noise_dn;
    result.saturation = saturation_of(histogram, result.layout, black_dn, radiometry.gain_e_per_dn,
                                      radiometry.read_noise_dn);
    radiometry.saturation_dn = result.saturation.saturation_dn;
}

void find_response(const SortedFrames& frames,
                   const FrameReader& read,
                   const RadiometryOptions& options,
                   RadiometryResult& result) {
    rig::Radiometry& radiometry = result.radiometry;
    result.flat =
        flat_field_of(frames.flats, result.layout, result.dark, radiometry, read, options.dead_rel);
    result.maps.response = result.flat->response;
    result.maps.response_sigma_rel = result.flat->response_sigma_rel;
    double variance = 0;
    for (std::size_t k = 0; k < result.maps.is_bad.size(); ++k) {
        if (result.flat->is_dead[k] != 0.0F)
            result.maps.is_bad[k] = 1.0F;
        const double sigma = result.flat->response_sigma_rel[k];
        variance += result.maps.is_bad[k] == 0.0F ? sigma * sigma : 0.0;
    }
    radiometry.prnu_sigma_rel =
        std::sqrt(variance / static_cast<double>(result.maps.is_bad.size()));
    radiometry.linearity_rel = result.flat->linearity_rel;
    radiometry.linear = result.flat->linear;
}

void require_unsaturated(const SortedFrames& frames) {
    constexpr double kAllSaturated = 0.9;
    double least = 2.0;
    for (const Bracket& bracket : frames.brackets) {
        for (const FrameRecord* record : bracket)
            least = std::min(least, record->share_saturated);
    }
    if (least <= 1.0 && least > kAllSaturated)
        throw Error{"all lights are saturated", "capture", "shorter exposures",
                    fmt::format("{:.0f} % of the least bright one", 100.0 * least)};
}

// 8 bits of unknown response: each bracket by itself could tell; the first that does is taken.
void recover(const SortedFrames& frames, const FrameReader& read, RadiometryResult& result) {
    const auto bracket = std::find_if(frames.brackets.begin(), frames.brackets.end(),
                                      [](const Bracket& b) { return b.size() >= 3; });
    if (bracket == frames.brackets.end())
        throw Error{"cannot recover the response of photographs", "capture",
                    "three exposures or more of one scene", "no such bracket"};
    std::vector<Photograph> photographs;
    for (const FrameRecord* record : *bracket) {
        require_same(result.layout, *record);
        const capture::Frame frame = read(*record);
        Photograph photograph;
        photograph.width_px = frame.size_px.x;
        const int shift = std::max(0, frame.bits - 8);
        for (const std::uint16_t value : frame.values)
            photograph.values.push_back(static_cast<std::uint8_t>(value >> shift));
        photograph.exposure_s =
            (record->exposure_us > 0.0 ? record->exposure_us : record->shot.exposure_us) * 1e-6;
        photographs.push_back(std::move(photograph));
    }
    result.response = recover_response(photographs, result.layout.channels, {});
    result.radiometry.linear =
        result.response->linear[static_cast<std::size_t>(result.layout.channels / 2)];
    result.radiometry.saturation_dn = result.layout.range_dn() * 245.0 / 255.0;
}

PixelLayout first_layout(const capture::Capture& capture) {
    if (capture.frames.empty())
        throw Error{"cannot calibrate", "capture", "frames", "none"};
    return layout_of(capture.frames.begin()->second);
}

}  // namespace

RadiometryOptions options_from(const capture::Plan& plan) {
    RadiometryOptions options;
    options.unknown_ratio_rel = plan.ratio_limit_rel;
    options.rgb_from_raw = plan.camera.rgb_from_raw;
    for (const double angle_deg : plan.screen.angle_deg)
        options.screen.x.push_back(glm::radians(angle_deg));
    options.screen.y = plan.screen.factor;
    if (plan.photometer) {
        options.photometer_correction = plan.photometer->correction;
        options.photometer_mismatch_rel = plan.photometer->mismatch_rel;
    }
    return options;
}

FrameReader reader_of(const std::string& folder) {
    return [folder](const FrameRecord& record) { return capture::read_frame(folder, record); };
}

SortedFrames sorted_frames(const capture::Capture& capture) {
    SortedFrames sorted;
    std::map<double, ExposureGroup> darks, flats;
    std::map<std::pair<int, int>, ExposureGroup> filters;
    std::map<std::tuple<int, int, int>, Bracket> brackets;
    for (const auto& [number, record] : capture.frames) {
        const capture::Shot& shot = record.shot;
        if (shot.kind == ShotKind::Dark || shot.kind == ShotKind::Flat) {
            ExposureGroup& group = (shot.kind == ShotKind::Dark ? darks : flats)[shot.exposure_us];
            group.exposure_us = shot.exposure_us;
            group.frames.push_back(&record);
        } else if (shot.kind == ShotKind::Filter) {
            ExposureGroup& group = filters[{shot.position.y, shot.position.x}];
            group.exposure_us = shot.exposure_us;
            group.frames.push_back(&record);
        } else if (shot.kind == ShotKind::Target) {
            sorted.targets.push_back(&record);
        } else if (shot.kind == ShotKind::Light) {
            brackets[{shot.position.y, shot.position.x, shot.repeat}].push_back(&record);
        }
    }
    sorted.darks = groups_of(darks);
    sorted.flats = groups_of(flats);
    sorted.filters = groups_of(filters);
    for (auto& [place, bracket] : brackets) {
        std::stable_sort(bracket.begin(), bracket.end(),
                         [](const FrameRecord* a, const FrameRecord* b) {
                             return a->shot.exposure_us < b->shot.exposure_us;
                         });
        sorted.brackets.push_back(std::move(bracket));
    }
    return sorted;
}

RadiometryResult calibrate_sensor(const capture::Capture& capture,
                                  const FrameReader& read,
                                  const RadiometryOptions& options,
                                  const RadiometryProgress& progress) {
    const Clock::time_point start = Clock::now();
    const SortedFrames frames = sorted_frames(capture);
    RadiometryResult result;
    result.layout = first_layout(capture);
    result.radiometry.bits = result.layout.bits;
    result.radiometry.mosaic = result.layout.mosaic;
    result.radiometry.rgb_from_raw = options.rgb_from_raw;
    result.radiometry.screen = options.screen;
    if (capture.header.response == capture::Response::Unknown) {
        recover(frames, read, result);
        result.time_s = seconds_since(start);
        return result;
    }
    require_unsaturated(frames);
    report(progress, "darks", 0.0);
    find_dark(frames, read, options, result);
    report(progress, "flats", 0.2);
    if (frames.flats.empty())
        throw Error{"cannot find noise and response", "capture",
                    "flats: two frames or more of an even source, at three exposures", "none"};
    find_noise(frames, read, result);
    report(progress, "veil of the lens", 0.4);
    result.veil =
        veil_of_targets(frames.targets, result.layout, result.dark, result.radiometry, read);
    if (result.veil.is_significant) {
        result.radiometry.veil_share = result.veil.share;
        result.radiometry.veil_sigma_px = result.veil.sigma_px;
    }
    report(progress, "response of pixels", 0.6);
    find_response(frames, read, options, result);
    report(progress, "true exposures", 0.7);
    result.ratios =
        exposure_ratios_of(frames.brackets, result.layout, result.dark, result.radiometry,
                           result.maps, read, options.unknown_ratio_rel);
    result.radiometry.exposures = result.ratios.exposures;
    flag_sensor(frames, result);
    list_sensor(result);
    report(progress, "true exposures", 1.0);
    result.time_s = seconds_since(start);
    return result;
}

}  // namespace nearfield::calibrate
