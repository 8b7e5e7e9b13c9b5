// SPDX-License-Identifier: Apache-2.0
#include "render/pass_plan.h"

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

int next_samples(const RenderOptions& options, const PictureSoFar& picture) {
    int samples = std::max(picture.most - picture.drawn, 0);
    if (options.error_rel > 0.0)
        samples =
            std::min(samples, samples_for_error(picture.noise.mean_rel,
                                                options.error_rel - picture.noise.bias_mean_rel,
                                                picture.drawn));
    if (options.time_s > 0.0) {
        const double correction =
            picture.last_s / std::max(picture.cost.of(picture.last_samples), 1e-9);
        const PassCost cost{picture.cost.fixed_s * correction,
                            picture.cost.per_sample_s * correction};
        samples = std::min(samples, samples_within(cost, kNextShare * picture.left_s));
        // A pass of few samples spends its time on sums that are known.
        if (samples < std::max(kFewestSamples, picture.drawn / 4) ||
            !(picture.noise.mean_rel > 0.0))
            samples = 0;
    }
    return samples >= 2 ? samples : 0;
}

double fraction_done(const RenderOptions& options,
                     const Noise& noise,
                     double elapsed_s,
                     double drawn,
                     double pass_drawn) {
    double fraction = 0.0;
    if (options.time_s > 0.0)
        fraction = elapsed_s / options.time_s;
    if (options.error_rel > 0.0 && drawn > 0.0) {
        const double ratio = std::max(noise.error_rel() / options.error_rel, 1.0);
        fraction = std::max(fraction, (drawn + pass_drawn) / (drawn * ratio * ratio));
    }
    return std::min(fraction, 1.0);
}

}  // namespace nearfield::render
