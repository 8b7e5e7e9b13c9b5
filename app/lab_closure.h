// SPDX-License-Identifier: Apache-2.0
/// How far a light field that was measured on a virtual bench is from the bench's truth.
#pragma once

#include "fit/fit_capture.h"
#include "formats/rig/rig.h"
#include "sample_data/bench/bench.h"

#include <vector>

namespace nearfield::app {

/// A receiver that faces the lamp: illuminance by formula, by the measured light field, and by a
/// fit of noise-free measurements with the same basis on the real bench.
struct ClosureReceiver {
    glm::dvec3 at_slab_m{0.0};
    double truth_lx = 0, fitted_lx = 0, noise_free_lx = 0, sigma_lx = 0;
};

/// Relative errors are over receivers whose intensity (E d^2) exceeds 1 % of the largest.
struct Closure {
    double irradiance_rms = 0;        // against the noise-free fit
    double irradiance_rms_truth = 0;  // against the formula
    double flux_rel = 0;              // total flux against the formula's
    double delta_rel = 0;             // of the rig
    double coverage_3sigma = 0;       // share of receivers within three sigma of the noise-free fit
    double noise_free_flux_rel = 0;   // of the noise-free fit: what the basis itself misses
    double lamp_factor = 1;           // the lamp's light at the reference's time over its nominal
    std::vector<ClosureReceiver> receivers;
};

/// In     time_s: of the first look at the reference, on the bench's clock
/// Throws Error where the bench's lamp is not the headlight by formula.
/// Cost   seconds: the noise-free measurements of all positions, their fit, 300 receivers.
Closure closure_of(const sample_data::Bench& bench,
                   double time_s,
                   const rig::Rig& rig,
                   const fit::CaptureFit& fit,
                   double model_error_rel);

}  // namespace nearfield::app
