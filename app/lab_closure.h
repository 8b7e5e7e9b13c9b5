// SPDX-License-Identifier: Apache-2.0
/// How far a light field that was measured on a virtual bench is from the bench's truth.
#pragma once

#include "app/lab_truth.h"
#include "fit/rectify_capture.h"

#include <string>
#include <vector>

namespace nearfield::app {

/// A receiver that faces the lamp: illuminance by formula, by the measured light field, and by a
/// fit of noise-free measurements with the same basis on the real bench.
struct ClosureReceiver {
    glm::dvec3 at_slab_m{0.0};
    double truth_lx = 0, fitted_lx = 0, noise_free_lx = 0, sigma_lx = 0;
};

/// One source of error by itself: a fit in which all else is the truth.
struct ErrorSource {
    std::string what;
    double irradiance_rms = 0;   // against the noise-free fit, over the receivers
    double irradiance_bias = 0;  // mean of the same
    double flux_rel = 0;         // against the noise-free fit
};

/// Relative errors are over receivers whose intensity (E d^2) exceeds 1 % of the largest.
struct Closure {
    double irradiance_rms = 0;        // against the noise-free fit
    double irradiance_rms_truth = 0;  // against the formula
    double basis_rms_truth = 0;       // the noise-free fit's own, against the formula
    double flux_rel = 0;              // total flux against the formula's
    double delta_rel = 0;             // of the rig
    double coverage_3sigma = 0;       // share of receivers within three sigma of the noise-free fit
    double noise_free_flux_rel = 0;   // of the noise-free fit: what the basis itself misses
    double lamp_factor = 1;           // the lamp's light at the reference's time over its nominal
    double cutoff_deg = 0;            // cut-off line 25 m away against the formula's, at most
    double cutoff_basis_deg = 0;      // the same of the noise-free fit
    double cutoff_gradient_deg = 0;   // the same of where log E falls fastest, which blur moves
    std::vector<ErrorSource> budget;
    std::vector<ClosureReceiver> receivers;
};

/// In     capture: what the fit was made of; options: as it was made
/// Cost   five fits of one channel, the noise-free measurements of all positions, 300 receivers and
///        the cut-off's scans by quadrature of the formula.
Closure closure_of(const LabTruth& truth,
                   double rig_delta_m,
                   const fit::RectifiedCapture& capture,
                   const fit::CaptureFitOptions& options,
                   const fit::CaptureFit& fit);

}  // namespace nearfield::app
