// SPDX-License-Identifier: Apache-2.0
#include "acquire/settings.h"

#include "acquire/checks.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace nearfield::acquire {
namespace {

constexpr int kLatestFrames = 4;       // no camera is later than this
constexpr double kLeastChange = 0.02;  // of the mean, beyond noise and flicker

double mean_of_next(Camera& camera, const ShouldStop& should_stop) {
    return capture::levels_of(camera.expose(should_stop).frame).mean_dn;
}

}  // namespace

void check_taken(const std::string& setting, double asked, double got, double tolerance_rel) {
    if (!(std::abs(got - asked) <= tolerance_rel * std::abs(asked)))
        throw Error{"the camera does not take a setting", setting, fmt::format("{:g}", asked),
                    fmt::format("{:g}", got)};
}

double set_exposure_checked(Camera& camera, double exposure_us) {
    const double got_us = camera.set_exposure(exposure_us);
    check_taken("exposure, us", exposure_us, got_us, kExposureRounding);
    return got_us;
}

int camera_latency(Camera& camera,
                   std::span<const double> exposures_us,
                   const ShouldStop& should_stop) {
    std::vector<double> means_dn;
    for (std::size_t step = 0; step + 1 < exposures_us.size(); ++step) {
        set_exposure_checked(camera, exposures_us[step]);
        for (int k = 0; k < kLatestFrames; ++k)
            mean_of_next(camera, should_stop);
        const double before_dn = mean_of_next(camera, should_stop);
        set_exposure_checked(camera, exposures_us[step + 1]);
        std::vector<double> after_dn;
        for (int k = 0; k <= kLatestFrames; ++k)
            after_dn.push_back(mean_of_next(camera, should_stop));
        if (const std::optional<int> latency = exposure_latency(before_dn, after_dn, kLeastChange))
            return *latency;
        means_dn.push_back(before_dn);
    }
    throw Error{"the camera ignores exposure, or sees no light", "all steps of the bracket",
                fmt::format("the frame's mean to change by more than {:g} %", 100 * kLeastChange),
                fmt::format("{:.1f} DN throughout", means_dn.empty() ? 0.0 : means_dn.back())};
}

}  // namespace nearfield::acquire
