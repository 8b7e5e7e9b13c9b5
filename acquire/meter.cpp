// SPDX-License-Identifier: Apache-2.0
#include "acquire/checks.h"
#include "acquire/session.h"
#include "acquire/settings.h"
#include "acquire/whole_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace nearfield::acquire {
namespace {

constexpr int kMostLooks = 12;  // exposures tried at one place
constexpr int kSettle = 4;  // frames dropped after a change: a camera's latency is not known yet

// The brightest pixel's share of the range above black, the mean of the darkest percent standing
// for black: light of the lamp leaves some of the screen dark.
double brightest_share(const capture::Frame& frame) {
    std::vector<std::uint16_t> values = frame.values;
    const auto dark = static_cast<std::ptrdiff_t>(values.size() / 100);
    std::nth_element(values.begin(), values.begin() + dark, values.end());
    const double black_dn = values[static_cast<std::size_t>(dark)];
    // A hot pixel is not the scene's brightest: one in ten thousand is left out.
    const auto bright = static_cast<std::ptrdiff_t>(values.size() - 1 - values.size() / 10000);
    std::nth_element(values.begin(), values.begin() + bright, values.end());
    return (values[static_cast<std::size_t>(bright)] - black_dn) / (frame.range_dn() - black_dn);
}

double look(Camera& camera, double exposure_us, const ShouldStop& should_stop) {
    set_exposure_checked(camera, exposure_us);
    for (int k = 0; k < kSettle; ++k)
        expose_whole(camera, should_stop);
    return brightest_share(expose_whole(camera, should_stop).frame);
}

// The brightest pixel's share of the range in a microsecond, by an exposure that shows it well.
double meter_here(Camera& camera,
                  const capture::BracketPlan& plan,
                  double start_us,
                  const ShouldStop& should_stop) {
    double exposure_us = start_us;
    for (int k = 0; k < kMostLooks; ++k) {
        const double share = look(camera, exposure_us, should_stop);
        if (share >= kWellExposedLow && share <= kWellExposedHigh)
            return share / exposure_us;
        constexpr double kDown = 0.25, kUp = 8;
        const double next_us =
            share > kWellExposedHigh
                ? exposure_us * kDown
                : std::min(exposure_us * kUp, exposure_us * 0.4 / std::max(share, 0.02));
        const double allowed_us = std::clamp(next_us, plan.least_us, plan.most_us);
        if (allowed_us == exposure_us)
            return share / exposure_us;  // bracket_of says what does not fit
        exposure_us = allowed_us;
    }
    throw Error{"metering finds no exposure", fmt::format("after {} looks", kMostLooks),
                "one that shows the brightest pixel well", fmt::format("{:g} us", exposure_us)};
}

}  // namespace

std::vector<double> meter(Bench& bench, const capture::Plan& plan, const ShouldStop& should_stop) {
    const glm::ivec2 last = plan.grid - 1;
    const std::array<glm::ivec2, 5> places = {
        plan.grid / 2, glm::ivec2(0), {last.x, 0}, {0, last.y}, last};
    double brightest = 0;
    double start_us = std::clamp(1000.0, plan.bracket.least_us, plan.bracket.most_us);
    for (const glm::ivec2 place : places) {
        capture::Shot shot;
        shot.position = place;
        bench.stage->arrange(shot, should_stop);
        const double per_us = meter_here(*bench.camera, plan.bracket, start_us, should_stop);
        brightest = std::max(brightest, per_us);
    }
    return capture::bracket_of(plan.bracket, brightest, kWellExposedLow, kWellExposedHigh);
}

}  // namespace nearfield::acquire
