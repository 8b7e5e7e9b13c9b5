// SPDX-License-Identifier: Apache-2.0
#include "fit/position_light.h"

#include "formats/files/error.h"
#include "formats/rig/veil.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::fit {
namespace {

using capture::FrameRecord;
using capture::ShotKind;

constexpr double kDarkDoubling_c = 7;  // silicon's dark current doubles every 6 ... 8 degrees
constexpr double kDriftRange = 0.8;    // of saturation: pixels brighter than that are no measure

double true_exposure_s(const rig::Radiometry& radiometry, const FrameRecord& frame) {
    constexpr double kSame = 1e-6;
    for (const rig::TrueExposure& exposure : radiometry.exposures)
        if (std::abs(exposure.asked_us - frame.shot.exposure_us) <= kSame * exposure.asked_us)
            return 1e-6 * exposure.true_us;
    return 1e-6 * (frame.exposure_us > 0 ? frame.exposure_us : frame.shot.exposure_us);
}

double dark_factor(const rig::Radiometry& radiometry, const PositionFrames& position) {
    double sum_c = 0;
    int count = 0;
    for (const FrameRecord* frame : position.frames)
        if (frame->temperature_c) {
            sum_c += *frame->temperature_c;
            ++count;
        }
    return count == 0
               ? 1.0
               : std::exp2((sum_c / count - radiometry.dark_temperature_c) / kDarkDoubling_c);
}

// Mean signal above dark over the pixels that are well below saturation in the first look.
class ReferenceMean {
  public:
    ReferenceMean(const Measurement& measurement, const FrameRecord& first)
        : measurement_(measurement) {
        const capture::Frame frame = read_frame(measurement.folder, first);
        const double limit_dn = kDriftRange * measurement.rig.radiometry->saturation_dn;
        for (std::size_t k = 0; k < frame.values.size(); ++k)
            if (frame.values[k] < limit_dn && measurement.maps.is_bad[k] == 0.0F)
                pixels_.push_back(k);
    }

    double rate_dn_per_s(const FrameRecord& record) const {
        const capture::Frame frame = read_frame(measurement_.folder, record);
        const double exposure_s = true_exposure_s(*measurement_.rig.radiometry, record);
        const rig::Maps& maps = measurement_.maps;
        double sum = 0;
        for (const std::size_t k : pixels_)
            sum += frame.values[k] - double(maps.black_dn[k]) -
                   exposure_s * double(maps.dark_dn_per_s[k]);
        return sum / exposure_s;
    }

  private:
    const Measurement& measurement_;
    std::vector<std::size_t> pixels_;
};

// Pixels that are not known get the mean of the known ones beside them, wave by wave from the edge
// of the hole inwards.
void fill_unknown(std::vector<float>& light,
                  const std::vector<float>& variance,
                  glm::ivec2 size_px) {
    std::vector<std::size_t> unknown;
    std::vector<char> is_known(light.size(), 1);
    for (std::size_t k = 0; k < light.size(); ++k)
        if (std::isinf(variance[k])) {
            unknown.push_back(k);
            is_known[k] = 0;
        }
    const auto width = static_cast<std::ptrdiff_t>(size_px.x);
    while (!unknown.empty()) {
        std::vector<std::pair<std::size_t, float>> filled;
        std::vector<std::size_t> left;
        for (const std::size_t k : unknown) {
            const auto x = static_cast<std::ptrdiff_t>(k) % width;
            double sum = 0;
            int count = 0;
            const auto look = [&](std::ptrdiff_t step, bool is_inside) {
                const auto neighbor =
                    static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + step);
                if (is_inside && neighbor < light.size() && is_known[neighbor] != 0) {
                    sum += double(light[neighbor]);
                    ++count;
                }
            };
            look(-1, x > 0);
            look(1, x + 1 < width);
            look(-width, static_cast<std::ptrdiff_t>(k) >= width);
            look(width, true);
            if (count > 0)
                filled.emplace_back(k, static_cast<float>(sum / count));
            else
                left.push_back(k);
        }
        if (filled.empty())
            return;  // nothing is known anywhere
        for (const auto& [k, value] : filled) {
            light[k] = value;
            is_known[k] = 1;
        }
        unknown = std::move(left);
    }
}

void take_off_veil(const Measurement& measurement, MergedImage& image) {
    const rig::Radiometry& radiometry = *measurement.rig.radiometry;
    if (radiometry.veil_share == 0)
        return;
    std::vector<float> filled = image.light_dn_per_s;
    fill_unknown(filled, image.variance, image.size_px);
    // The veil is spread over what the sensor sees, the response is the lens' and the pixel's own.
    for (std::size_t k = 0; k < filled.size(); ++k)
        filled[k] *= measurement.maps.response[k];
    const std::vector<float> without = rig::remove_veil(filled, image.size_px, radiometry);
    for (std::size_t k = 0; k < filled.size(); ++k)
        image.light_dn_per_s[k] = without[k] / measurement.maps.response[k];
}

}  // namespace

std::vector<PositionFrames> positions_of(const capture::Capture& capture) {
    std::map<std::pair<int, int>, PositionFrames> by_place;
    for (const auto& [number, frame] : capture.frames)
        if (frame.shot.kind == ShotKind::Light) {
            PositionFrames& position = by_place[{frame.shot.position.y, frame.shot.position.x}];
            position.position = frame.shot.position;
            position.frames.push_back(&frame);
        }
    std::vector<PositionFrames> positions;
    for (auto& [place, position] : by_place)
        positions.push_back(std::move(position));
    return positions;
}

void check_rig(const Measurement& measurement) {
    const rig::Rig& rig = measurement.rig;
    if (!rig.lens || !rig.planes || !rig.radiometry)
        throw Error{"the rig does not suffice", "rig", "lens, planes and radiometry",
                    fmt::format("{}{}{}", rig.lens ? "lens " : "", rig.planes ? "planes " : "",
                                rig.radiometry ? "radiometry" : "")};
    for (const auto& [number, frame] : measurement.capture.frames) {
        if (frame.size_px != rig.lens->size_px)
            throw Error{
                "rig is not this capture's", measurement.folder + "/" + frame.file,
                fmt::format("{} x {} px, as the rig", rig.lens->size_px.x, rig.lens->size_px.y),
                fmt::format("{} x {} px", frame.size_px.x, frame.size_px.y)};
        if (frame.bits != rig.radiometry->bits)
            throw Error{"rig is not this capture's", measurement.folder + "/" + frame.file,
                        fmt::format("{} bits, as the rig", rig.radiometry->bits),
                        fmt::format("{} bits", frame.bits)};
        const glm::ivec2 position = frame.shot.position;
        if (position.x >= rig.planes->grid.x || position.y >= rig.planes->grid.y)
            throw Error{"rig is not this capture's", measurement.folder + "/" + frame.file,
                        fmt::format("a position of the rig's {} x {}", rig.planes->grid.x,
                                    rig.planes->grid.y),
                        fmt::format("column {}, row {}", position.x, position.y)};
    }
}

LampDrift::LampDrift(const Measurement& measurement) {
    std::vector<const FrameRecord*> references;
    for (const auto& [number, frame] : measurement.capture.frames)
        if (frame.shot.kind == ShotKind::Reference)
            references.push_back(&frame);
    if (references.empty())
        return;
    const ReferenceMean mean(measurement, *references.front());
    const double first = mean.rate_dn_per_s(*references.front());
    for (const FrameRecord* frame : references) {
        const double factor = mean.rate_dn_per_s(*frame) / first;
        by_session_[frame->session].emplace_back(1e-6 * static_cast<double>(frame->time_us),
                                                 factor);
        largest_rel_ = std::max(largest_rel_, std::abs(factor - 1));
        ++looks_;
    }
    for (auto& [session, looks] : by_session_)
        std::sort(looks.begin(), looks.end());
}

double LampDrift::factor(const FrameRecord& frame) const {
    const auto session = by_session_.find(frame.session);
    if (session == by_session_.end())
        return 1;
    const auto& looks = session->second;
    const double time_s = 1e-6 * static_cast<double>(frame.time_us);
    const auto after = std::lower_bound(looks.begin(), looks.end(), std::pair(time_s, 0.0));
    if (after == looks.begin())
        return looks.front().second;
    if (after == looks.end())
        return looks.back().second;
    const auto& [time0_s, factor0] = *std::prev(after);
    const auto& [time1_s, factor1] = *after;
    return factor0 + (factor1 - factor0) * (time_s - time0_s) / (time1_s - time0_s);
}

MergedImage position_light(const Measurement& measurement,
                           const PositionFrames& position,
                           const LampDrift& drift) {
    std::vector<capture::Frame> frames;
    std::vector<ExposedFrame> exposed;
    double factor = 0;
    frames.reserve(position.frames.size());
    for (const FrameRecord* record : position.frames) {
        frames.push_back(read_frame(measurement.folder, *record));
        exposed.push_back(
            {frames.back().values, true_exposure_s(*measurement.rig.radiometry, *record)});
        factor += drift.factor(*record) / static_cast<double>(position.frames.size());
    }
    MergedImage image = merge_frames(exposed, *measurement.rig.radiometry, measurement.maps,
                                     dark_factor(*measurement.rig.radiometry, position));
    take_off_veil(measurement, image);
    for (std::size_t k = 0; k < image.light_dn_per_s.size(); ++k) {
        image.light_dn_per_s[k] /= static_cast<float>(factor);
        image.variance[k] /= static_cast<float>(factor * factor);
    }
    return image;
}

}  // namespace nearfield::fit
