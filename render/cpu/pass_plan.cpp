// SPDX-License-Identifier: Apache-2.0
#include "render/cpu/pass_plan.h"

#include "render/options.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render {

PassCost cost_from(int samples_a, double time_a_s, int samples_b, double time_b_s) {
    PassCost cost;
    cost.per_sample_s = std::max((time_b_s - time_a_s) / (samples_b - samples_a), 0.0);
    cost.fixed_s = std::max(time_a_s - cost.per_sample_s * samples_a, 0.0);
    return cost;
}

int samples_for_error(double reached_rel, double wanted_rel, int drawn) {
    if (!(wanted_rel > 0.0) || reached_rel <= wanted_rel)
        return 0;
    const double ratio = reached_rel / wanted_rel;
    const double needed = drawn * (ratio * ratio - 1.0);
    return static_cast<int>(std::ceil(std::clamp(needed, 0.25 * drawn, 3.0 * drawn)));
}

int samples_within(const PassCost& cost, double left_s) {
    const double left_for_samples_s = left_s - cost.fixed_s;
    if (!(left_for_samples_s > 0.0))
        return 0;
    if (left_for_samples_s >= cost.per_sample_s * kMostSamples)
        return kMostSamples;
    return static_cast<int>(left_for_samples_s / cost.per_sample_s);
}

}  // namespace nearfield::render
