// SPDX-License-Identifier: Apache-2.0
/// How many samples the next pass over a picture draws, from the error so far and what passes cost.
#pragma once

#include "render/options.h"
#include "render/report.h"

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

/// Of the time that is left, what a pass after the first may plan for: the rest is for what the
/// machine does besides.
constexpr double kNextShare = 0.9;

/// A picture in the making, with something asked for: error_rel, time_s or both.
struct PictureSoFar {
    int drawn = 0, most = kMostSamples;  // samples of a pixel and lamp: so far, and at most in all
    Noise noise;
    PassCost cost;         // of passes, as planned
    int last_samples = 0;  // of the last pass,
    double last_s = 0;     // and what it took, which corrects the cost
    double left_s = 0;     // of time_s
};

/// Samples of the next pass; 0: the picture is done, or nothing that is asked for can be had.
int next_samples(const RenderOptions& options, const PictureSoFar& picture);

/// Of all work, as far as is known: towards the error by its square, and of the time. drawn:
/// samples of complete passes, whose noise it is; pass_drawn: of the running one.
double fraction_done(const RenderOptions& options,
                     const Noise& noise,
                     double elapsed_s,
                     double drawn,
                     double pass_drawn);

}  // namespace nearfield::render
