// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/plan.h"

#include "formats/capture/words.h"
#include "formats/files/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nearfield::capture {
namespace {

// 0 where there is no bracket.
double middle_exposure_us(const Plan& plan) {
    const std::vector<double>& exposures_us = plan.bracket.exposures_us;
    return exposures_us.empty() ? 0 : exposures_us[exposures_us.size() / 2];
}

std::vector<Shot> lights_of(const Plan& plan) {
    std::vector<Shot> shots;
    for (int k = 0; k < plan.grid.x * plan.grid.y; ++k) {
        if (plan.drift_every > 0 && k % plan.drift_every == 0)
            shots.push_back({0, ShotKind::Reference, plan.grid / 2, -1, middle_exposure_us(plan),
                             k / plan.drift_every});
        const int row = k / plan.grid.x, step = k % plan.grid.x;
        const glm::ivec2 position{row % 2 == 0 ? step : plan.grid.x - 1 - step, row};
        for (const double exposure_us : plan.bracket.exposures_us)
            for (int repeat = 0; repeat < plan.repeats; ++repeat)
                shots.push_back({0, ShotKind::Light, position, -1, exposure_us, repeat});
    }
    return shots;
}

constexpr Words<ShotKind, 7> kShotKinds{{{"target", ShotKind::Target},
                                         {"flat", ShotKind::Flat},
                                         {"filter", ShotKind::Filter},
                                         {"dark", ShotKind::Dark},
                                         {"blocked", ShotKind::Blocked},
                                         {"light", ShotKind::Light},
                                         {"reference", ShotKind::Reference}}};

std::vector<Shot> targets_of(const Plan& plan) {
    const double exposure_us =
        plan.target_exposure_us > 0 ? plan.target_exposure_us : middle_exposure_us(plan);
    std::vector<Shot> shots;
    for (std::size_t view = 0; view < plan.views.size(); ++view)
        shots.push_back(
            {0, ShotKind::Target, glm::ivec2(-1), static_cast<int>(view), exposure_us, 0});
    return shots;
}

std::vector<Shot> flats_of(const Plan& plan) {
    const std::vector<double> exposures_us = plan.flat_exposures_us.empty()
                                                 ? std::vector{middle_exposure_us(plan)}
                                                 : plan.flat_exposures_us;
    std::vector<Shot> shots;
    for (const double exposure_us : exposures_us)
        for (int repeat = 0; repeat < plan.flats; ++repeat)
            shots.push_back({0, ShotKind::Flat, glm::ivec2(-1), -1, exposure_us, repeat});
    return shots;
}

std::vector<Shot> filter_views_of(const Plan& plan) {
    const double exposure_us = plan.filter_views.exposure_us > 0 ? plan.filter_views.exposure_us
                                                                 : middle_exposure_us(plan);
    std::vector<Shot> shots;
    for (const glm::ivec2 position : plan.filter_views.positions)
        shots.push_back({0, ShotKind::Filter, position, -1, exposure_us, 0});
    return shots;
}

std::vector<Shot> blocked_of(const Plan& plan) {
    std::vector<Shot> shots;
    for (const double exposure_us : plan.bracket.exposures_us)
        for (int repeat = 0; repeat < plan.blocked; ++repeat)
            shots.push_back({0, ShotKind::Blocked, glm::ivec2(-1), -1, exposure_us, repeat});
    return shots;
}

// At every exposure of the bracket and of the other shots.
std::vector<Shot> darks_of(const Plan& plan, const std::vector<Shot>& others) {
    std::vector<double> exposures_us = plan.bracket.exposures_us;
    for (const Shot& shot : others)
        if (std::find(exposures_us.begin(), exposures_us.end(), shot.exposure_us) ==
            exposures_us.end())
            exposures_us.push_back(shot.exposure_us);
    std::vector<Shot> shots;
    for (const double exposure_us : exposures_us)
        for (int repeat = 0; repeat < plan.darks; ++repeat)
            shots.push_back({0, ShotKind::Dark, glm::ivec2(-1), -1, exposure_us, repeat});
    return shots;
}

// The sensor is warmer then than it was before the lights.
std::vector<Shot> darks_after(const Plan& plan) {
    std::vector<Shot> shots;
    for (const double exposure_us : plan.bracket.exposures_us)
        for (int repeat = 0; repeat < plan.darks_after; ++repeat)
            shots.push_back(
                {0, ShotKind::Dark, glm::ivec2(-1), -1, exposure_us, plan.darks + repeat});
    return shots;
}

}  // namespace

std::string word_of(ShotKind kind) {
    return word_for(kShotKinds, kind);
}

ShotKind shot_kind_from(const JsonField& word) {
    return meaning_of(kShotKinds, word);
}

std::string name_of(const Shot& shot) {
    std::string name = word_of(shot.kind);
    if (shot.view >= 0)
        name += fmt::format("_v{:03}", shot.view);
    if (shot.position.x >= 0)
        name += fmt::format("_x{:03}_y{:03}", shot.position.x, shot.position.y);
    return name + fmt::format("_{:.4g}us_r{:03}", shot.exposure_us, shot.repeat);
}

std::vector<Shot> shots_of(const Plan& plan) {
    std::vector<Shot> shots;
    const auto append = [&shots](const std::vector<Shot>& more) {
        shots.insert(shots.end(), more.begin(), more.end());
    };
    append(targets_of(plan));
    append(flats_of(plan));
    append(filter_views_of(plan));
    append(darks_of(plan, shots));
    append(blocked_of(plan));
    append(lights_of(plan));
    append(darks_after(plan));
    for (std::size_t k = 0; k < shots.size(); ++k)
        shots[k].number = static_cast<int>(k);
    return shots;
}

double estimate_time_s(const Plan& plan, const std::vector<Shot>& shots, double overhead_s) {
    double time_s = 0;
    glm::ivec2 position{-1};
    for (const Shot& shot : shots) {
        time_s += shot.exposure_us * 1e-6 + overhead_s;
        if (shot.position != position)
            time_s += plan.settle_s;
        position = shot.position;
    }
    return time_s;
}

std::vector<double> bracket_of(const BracketPlan& plan,
                               double brightest_per_us,
                               double low,
                               double high) {
    // A pixel is well exposed over a range of high / low in exposure; steps of its root put two
    // exposures into it wherever it lies.
    const double step = std::sqrt(high / low);
    const double shortest_us = high / brightest_per_us / step;
    // Where all is equally bright, two exposures still differ, so that their ratio can be checked.
    const double longest_us = std::max(low / (brightest_per_us * plan.darkest_share) * step,
                                       shortest_us * std::sqrt(step));
    if (shortest_us < plan.least_us || longest_us > plan.most_us)
        throw Error{
            "no bracket exposes every pixel well twice",
            fmt::format(
                "brightest pixel saturates after {:.3g} us, darkest of interest is {:g} of it",
                1 / brightest_per_us, plan.darkest_share),
            fmt::format("exposures within {:g} ... {:g} us", plan.least_us, plan.most_us),
            fmt::format("{:.3g} ... {:.3g} us needed", shortest_us, longest_us)};
    const int steps = std::max(
        1, static_cast<int>(std::ceil(std::log(longest_us / shortest_us) / std::log(step) - 1e-9)));
    std::vector<double> exposures_us;
    for (int k = 0; k <= steps; ++k)
        exposures_us.push_back(shortest_us *
                               std::pow(longest_us / shortest_us, static_cast<double>(k) / steps));
    return exposures_us;
}

}  // namespace nearfield::capture
