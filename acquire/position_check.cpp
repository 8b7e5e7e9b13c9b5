// SPDX-License-Identifier: Apache-2.0
#include "acquire/position_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nearfield::acquire {

using capture::Shot;
using capture::ShotKind;

PositionCheck::PositionCheck(const capture::Capture& capture) : plan_(capture.header.plan.value()) {
    for (const auto& [number, record] : capture.frames)
        add_level(record.shot, record.mean_dn);
    figures_ = {};
    since_reference_.clear();
    finding_.reset();
}

void PositionCheck::add(const Shot& shot, const capture::Frame& frame) {
    if (!position_.empty() && position_.front().shot.position != shot.position)
        finish_position();
    add_level(shot, capture::levels_of(frame).mean_dn);
    if (shot.kind == ShotKind::Light) {
        since_reference_.push_back(shot.number);
        if (shot.repeat == 0)
            position_.push_back({shot, frame});
    }
}

void PositionCheck::finish() {
    finish_position();
}

std::optional<Finding> PositionCheck::judge() {
    return std::exchange(finding_, std::nullopt);
}

void PositionCheck::add_level(const Shot& shot, double mean_dn) {
    if (shot.kind == ShotKind::Dark) {
        auto& [sum_dn, count] = darks_[shot.exposure_us];
        sum_dn += mean_dn;
        ++count;
    } else if (shot.kind == ShotKind::Reference) {
        add_reference(shot, mean_dn);
    }
}

void PositionCheck::add_reference(const Shot& shot, double mean_dn) {
    const double level_dn = mean_dn - black_dn(shot.exposure_us);
    if (!first_reference_dn_)
        first_reference_dn_ = level_dn;
    const double drift_rel = std::abs(level_dn / *first_reference_dn_ - 1);
    figures_.worst_drift_rel = std::max(figures_.worst_drift_rel, drift_rel);
    if (drift_rel > plan_.drift_limit_rel) {
        since_reference_.push_back(shot.number);
        finding_ =
            Finding{Error{"the lamp drifts", name_of(shot),
                          fmt::format("light at the reference within {:g} % of the first look",
                                      100 * plan_.drift_limit_rel),
                          fmt::format("{:+.2f} %", 100 * (level_dn / *first_reference_dn_ - 1))},
                    since_reference_};
    }
    since_reference_.clear();
}

// Without darks at this exposure, those of the nearest one: black depends on it little.
double PositionCheck::black_dn(double exposure_us) const {
    const auto nearest =
        std::min_element(darks_.begin(), darks_.end(), [exposure_us](const auto& a, const auto& b) {
            return std::abs(std::log(a.first / exposure_us)) <
                   std::abs(std::log(b.first / exposure_us));
        });
    return nearest == darks_.end() ? 0 : nearest->second.first / nearest->second.second;
}

void PositionCheck::finish_position() {
    std::vector<Signal> bracket;
    std::vector<int> numbers;
    for (const Kept& kept : position_) {
        bracket.push_back({&kept.frame, black_dn(kept.shot.exposure_us), kept.shot.exposure_us});
        numbers.push_back(kept.shot.number);
    }
    if (bracket.size() == plan_.bracket.exposures_us.size())
        tally(bracket, figures_.exposures);
    for (std::size_t k = 0; k + 1 < bracket.size(); ++k) {
        const std::optional<double> ratio = exposure_ratio(bracket[k], bracket[k + 1]);
        if (!ratio)
            continue;
        const double asked = bracket[k + 1].exposure_us / bracket[k].exposure_us;
        const double deviation_rel = *ratio / asked - 1;
        ++figures_.ratios;
        figures_.worst_ratio_rel = std::max(figures_.worst_ratio_rel, std::abs(deviation_rel));
        if (std::abs(deviation_rel) > plan_.ratio_limit_rel && !finding_)
            finding_ =
                Finding{Error{"true exposures are not those asked for",
                              fmt::format("{} against {:g} us", name_of(position_[k + 1].shot),
                                          bracket[k].exposure_us),
                              fmt::format("{:.4g} times the light, within {:g} %", asked,
                                          100 * plan_.ratio_limit_rel),
                              fmt::format("{:.4g} times", *ratio)},
                        numbers};
    }
    position_.clear();
}

}  // namespace nearfield::acquire
