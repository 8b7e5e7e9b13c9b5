// SPDX-License-Identifier: Apache-2.0
#include "acquire/settings.h"

#include "acquire/checks.h"
#include "acquire/whole_frame.h"

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

// Means of the frame before a change of exposure and of those after it.
struct Step {
    double before_dn = 0;
    std::vector<double> after_dn;
};

Step step_of(Camera& camera, double from_us, double to_us, const ShouldStop& should_stop) {
    Step step;
    set_exposure_checked(camera, from_us);
    for (int k = 0; k < kLatestFrames; ++k)
        mean_of_next(camera, should_stop);
    step.before_dn = mean_of_next(camera, should_stop);
    set_exposure_checked(camera, to_us);
    for (int k = 0; k <= kLatestFrames; ++k)
        step.after_dn.push_back(mean_of_next(camera, should_stop));
    return step;
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
    for (std::size_t k = 0; k + 1 < exposures_us.size(); ++k) {
        // A torn frame among them would be missing in the count: the step is taken anew.
        const Step step = until_whole(
            [&] { return step_of(camera, exposures_us[k], exposures_us[k + 1], should_stop); });
        if (const std::optional<int> latency =
                exposure_latency(step.before_dn, step.after_dn, kLeastChange))
            return *latency;
        means_dn.push_back(step.before_dn);
    }
    throw Error{"the camera ignores exposure, or sees no light", "all steps of the bracket",
                fmt::format("the frame's mean to change by more than {:g} %", 100 * kLeastChange),
                fmt::format("{:.1f} DN throughout", means_dn.empty() ? 0.0 : means_dn.back())};
}

}  // namespace nearfield::acquire
