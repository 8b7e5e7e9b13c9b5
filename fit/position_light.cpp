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

constexpr double kDriftRange = 0.8;  // of saturation: pixels brighter than that are no measure

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
    return count == 0 ? 1.0 : rig::dark_growth(sum_c / count - radiometry.dark_temperature_c);
}

void check_map(const std::vector<float>& map, const char* name, glm::ivec2 size_px) {
    const auto pixels = static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
    if (map.size() != pixels)
        throw Error{"the rig's maps do not fit", name, fmt::format("{} pixels", pixels),
                    fmt::format("{}", map.size())};
    const auto wrong =
        std::find_if(map.begin(), map.end(), [](float value) { return !std::isfinite(value); });
    if (wrong == map.end())
        return;
    const auto at = static_cast<int>(wrong - map.begin());
    throw Error{"a map of the rig holds what is no number",
                fmt::format("{} at pixel ({}, {})", name, at % size_px.x, at / size_px.x),
                "finite numbers", fmt::format("{}", *wrong)};
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
        if (pixels_.empty())
            throw Error{"a look at the reference is saturated", name_of(first.shot),
                        fmt::format("pixels below {:g} DN", limit_dn), "none"};
    }

    double rate_dn_per_s(const FrameRecord& record) const {
        const capture::Frame frame = read_frame(measurement_.folder, record);
        const double exposure_s = true_exposure_s(*measurement_.rig.radiometry, record);
        const rig::Maps& maps = measurement_.maps;
        const double growth = rig::dark_growth(*measurement_.rig.radiometry, record.temperature_c);
        double sum = 0;
        for (const std::size_t k : pixels_)
            sum += frame.values[k] - double(maps.black_dn[k]) -
                   exposure_s * rig::dark_rate_dn_per_s(maps, k, growth);
        return sum / exposure_s;
    }

  private:
    const Measurement& measurement_;
    std::vector<std::size_t> pixels_;
};

// Known neighbors to the left, right, above and below.
struct Neighbors {
    double sum = 0, squares = 0, variance = 0;
    int count = 0;
};

Neighbors known_neighbors(const MergedImage& image,
                          const std::vector<char>& is_known,
                          std::size_t k) {
    const auto width = static_cast<std::size_t>(image.size_px.x);
    Neighbors neighbors;
    const auto look = [&](bool is_inside, std::size_t neighbor) {
        if (!is_inside || is_known[neighbor] == 0)
            return;
        const double light = double(image.light_dn_per_s[neighbor]);
        neighbors.sum += light;
        neighbors.squares += light * light;
        neighbors.variance += double(image.variance[neighbor]);
        ++neighbors.count;
    };
    look(k % width > 0, k - 1);
    look(k % width + 1 < width, k + 1);
    look(k >= width, k - width);
    look(k + width < is_known.size(), k + width);
    return neighbors;
}

// Bad pixels take the mean of the known ones beside them, with their noise and their spread.
void bridge_bad_pixels(const std::vector<float>& is_bad, MergedImage& image) {
    std::vector<char> is_known(is_bad.size());
    for (std::size_t k = 0; k < is_bad.size(); ++k)
        is_known[k] = std::isfinite(image.variance[k]) ? 1 : 0;
    for (std::size_t k = 0; k < is_bad.size(); ++k) {
        if (is_bad[k] == 0.0F)
            continue;
        const Neighbors neighbors = known_neighbors(image, is_known, k);
        constexpr int kLeast = 2;
        if (neighbors.count < kLeast)
            continue;
        const double mean = neighbors.sum / neighbors.count;
        const double spread = std::max(0.0, neighbors.squares / neighbors.count - mean * mean);
        image.light_dn_per_s[k] = static_cast<float>(mean);
        image.variance[k] = static_cast<float>(spread + neighbors.variance / neighbors.count);
    }
}

// Light with unknown pixels filled wave by wave from the edge of the hole inwards.
std::vector<float> filled_light(MergedImage image) {
    std::vector<char> is_known(image.light_dn_per_s.size());
    std::vector<std::size_t> unknown;
    for (std::size_t k = 0; k < is_known.size(); ++k) {
        is_known[k] = std::isfinite(image.variance[k]) ? 1 : 0;
        if (is_known[k] == 0)
            unknown.push_back(k);
    }
    while (!unknown.empty()) {
        std::vector<std::size_t> filled, left;
        for (const std::size_t k : unknown) {
            const Neighbors neighbors = known_neighbors(image, is_known, k);
            (neighbors.count > 0 ? filled : left).push_back(k);
            if (neighbors.count > 0)
                image.light_dn_per_s[k] = static_cast<float>(neighbors.sum / neighbors.count);
        }
        if (filled.empty())
            break;  // nothing is known anywhere
        for (const std::size_t k : filled)
            is_known[k] = 1;
        unknown = std::move(left);
    }
    return std::move(image.light_dn_per_s);
}

void take_off_veil(const Measurement& measurement, MergedImage& image) {
    const rig::Radiometry& radiometry = *measurement.rig.radiometry;
    if (radiometry.veil_share == 0)
        return;
    std::vector<float> filled = filled_light(image);
    // The veil is spread over what the sensor sees, the response is the lens' and the pixel's own.
    for (std::size_t k = 0; k < filled.size(); ++k)
        filled[k] *= measurement.maps.response[k];
    const std::vector<float> without = rig::remove_veil(filled, image.size_px, radiometry);
    for (std::size_t k = 0; k < filled.size(); ++k)
        image.light_dn_per_s[k] = without[k] / measurement.maps.response[k];
}

}  // namespace

double time_s(const FrameRecord& frame) {
    return frame.camera_time_ns > 0 ? 1e-9 * static_cast<double>(frame.camera_time_ns)
                                    : 1e-6 * static_cast<double>(frame.time_us);
}

std::vector<PositionFrames> positions_of(const capture::Capture& capture) {
    std::map<std::pair<int, int>, PositionFrames> by_place;
    for (const auto& [number, frame] : capture.frames)
        if (frame.shot.kind == ShotKind::Light) {
            PositionFrames& position = by_place[{frame.shot.position.y, frame.shot.position.x}];
            position.position = frame.shot.position;
            position.frames.push_back(&frame);
        }
    std::vector<PositionFrames> positions;
    positions.reserve(by_place.size());
    for (auto& [place, position] : by_place)
        positions.push_back(std::move(position));
    return positions;
}

PositionFrames blocked_frames(const capture::Capture& capture) {
    PositionFrames blocked;
    blocked.position = glm::ivec2(-1);
    for (const auto& [number, frame] : capture.frames)
        if (frame.shot.kind == ShotKind::Blocked)
            blocked.frames.push_back(&frame);
    return blocked;
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
    const rig::Maps& maps = measurement.maps;
    check_map(maps.black_dn, "black_dn", rig.lens->size_px);
    check_map(maps.dark_dn_per_s, "dark_dn_per_s", rig.lens->size_px);
    check_map(maps.room_dn_per_s, "room_dn_per_s", rig.lens->size_px);
    check_map(maps.response, "response", rig.lens->size_px);
    check_map(maps.is_bad, "is_bad", rig.lens->size_px);
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
    if (!(first > 0.0))
        throw Error{"a look at the reference shows no light", name_of(references.front()->shot),
                    "the lamp through the filter in the grid's middle", "darkness"};
    for (const FrameRecord* frame : references) {
        const double factor = mean.rate_dn_per_s(*frame) / first;
        by_session_[frame->session].emplace_back(time_s(*frame), factor);
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
    const double at_s = time_s(frame);
    const auto after = std::lower_bound(looks.begin(), looks.end(), std::pair(at_s, 0.0));
    if (after == looks.begin())
        return looks.front().second;
    if (after == looks.end())
        return looks.back().second;
    const auto& [time0_s, factor0] = *std::prev(after);
    const auto& [time1_s, factor1] = *after;
    return factor0 + (factor1 - factor0) * (at_s - time0_s) / (time1_s - time0_s);
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
    bridge_bad_pixels(measurement.maps.is_bad, image);
    take_off_veil(measurement, image);
    for (std::size_t k = 0; k < image.light_dn_per_s.size(); ++k) {
        image.light_dn_per_s[k] /= static_cast<float>(factor);
        image.variance[k] /= static_cast<float>(factor * factor);
    }
    return image;
}

}  // namespace nearfield::fit
