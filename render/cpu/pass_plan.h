// SPDX-License-Identifier: Apache-2.0
/// How many samples the next pass over a picture draws, from the error so far and what passes cost.
#pragma once

namespace nearfield::render {

/// What a pass takes: camera rays and light sums, and samples.
struct PassCost {
    double fixed_s = 0, per_sample_s = 0;

    double of(int samples) const { return fixed_s + per_sample_s * samples; }
};

/// The cost from two passes' times.
PassCost cost_from(int samples_a, double time_a_s, int samples_b, double time_b_s);

/// Samples of the next pass towards an error: as many as it takes if the error falls with the root
/// of all samples (stratified ones do better), but at least a quarter and at most three times what
/// has been drawn, since the error is an estimate. 0 where it is reached or cannot be (wanted <=
/// 0).
int samples_for_error(double reached_rel, double wanted_rel, int drawn);

/// The most samples a pass may have to end within left_s; 0 where not even one.
int samples_within(const PassCost& cost, double left_s);

}  // namespace nearfield::render
