// SPDX-License-Identifier: Apache-2.0
/// Lamps on which estimators are tested by statistics, and what repeated runs of one give.
#pragma once

#include "formats/files/lightfield.h"
#include "formats/model/sampler.h"
#include "tests/support/lamps.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nearfield::model {

/// A lamp and a receiver in the luminaire's frame, rounded to float in every slab.
struct EstimatorCase {
    std::string name;
    LightField lightfield;
    Receiver receiver;
};

/// The reference lamp, one lit texel, a range of 1e10 within one image, W != H in color with
/// radiance weighting, and two slabs.
std::vector<EstimatorCase> estimator_cases();

/// Ready to sample: slabs, and the receiver in each of their frames.
struct ReadyCase {
    std::vector<SamplingSlab> slabs;
    std::vector<ReceiverF> receivers;
    /// By the oracle, in luminance, at the receivers as they are in float.
    double truth_y = 0;
};
ReadyCase make_ready(const EstimatorCase& from);

/// Mean and standard error of estimates of Y.
struct Runs {
    double mean = 0, standard_error = 0, deviation = 0;
};

/// Runs an estimator `count` times, each with its own shift. Equal for any number of threads.
Runs run(const ReadyCase& ready,
         const SamplerOptions& options,
         int count,
         const std::function<glm::vec2(std::uint32_t run)>& shift);

/// A random shift of both coordinates, a function of seed and run.
std::function<glm::vec2(std::uint32_t)> random_shift(std::uint32_t seed);

/// Standard errors between a mean and the truth. Rounding in float, 1e-5 of the truth (sums of a
/// hundred images' energies), counts as one more: without it an estimator without noise would fail
/// by it.
double z_score(const Runs& runs, double truth);

}  // namespace nearfield::model
